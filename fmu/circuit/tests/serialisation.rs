//! Serialised states of the circuit: the run goes on to the last bit; nonsense is refused.
#![allow(clippy::expect_used)] // helpers outside of #[test] functions fail a test, too

use HarvestingCircuit::Harvesting;
use fmu_export::{Slave, StateError};
use fmu_host::slave::{self, bytes, initialized, outputs, set};

fn restored(bytes: &[u8]) -> Result<Harvesting, StateError> {
    slave::restored(bytes, &Harvesting::new())
}

/// Steps number `from` to `to` of 10 ms with pulsating capacitances; the outputs after each.
fn steps(slave: &mut Harvesting, from: u32, to: u32) -> Vec<Vec<u64>> {
    let step = |k: u32| {
        let swing = |shift: f64| 15e-12 + 6e-12 * (0.3 * f64::from(k) + shift).sin();
        set(slave, "left.capacitance", swing(0.0));
        set(slave, "right.capacitance", swing(2.0));
        slave::step(slave, 0.01 * f64::from(k), 0.01);
        outputs(slave)
    };
    (from..to).map(step).collect()
}

#[test]
fn a_restored_circuit_goes_on_to_the_last_bit() {
    let open = f64::INFINITY;
    for settings in [
        &[][..],
        &[("topology", 2.0), ("release", 2.0), ("zener.voltage", 2100.0)],
        &[("diode.model", 2.0), ("zener.voltage", 2100.0)],
        &[("topology", 2.0), ("load.resistance", open)],
        &[("load.resistance", 0.0)],
        &[("release", 3.0), ("topology", 2.0), ("storage.voltage", 2400.0)],
        &[("release", 3.0), ("diode.model", 2.0)],
    ] {
        for taken in [0, 1, 7, 20] {
            let mut original = initialized(settings);
            steps(&mut original, 0, taken);
            let mut copy = restored(&bytes(&original)).expect("a state");
            assert_eq!(steps(&mut copy, taken, 40), steps(&mut original, taken, 40), "{settings:?} after {taken}");
        }
    }
}

#[test]
fn bytes_that_are_no_state_are_refused() {
    let mut slave = initialized(&[]);
    steps(&mut slave, 0, 13);
    let good = bytes(&slave);
    for length in 0..good.len() {
        assert!(restored(&good[..length]).is_err(), "{length} bytes");
    }
    assert!(restored(&[good.as_slice(), &[0]].concat()).is_err());
    let mut found = 0;
    for value in outputs(&slave).into_iter().map(f64::from_bits).filter(|value| *value != 0.0) {
        let Some(offset) = good.windows(8).position(|window| window == value.to_le_bytes()) else { continue };
        found += 1;
        for nonsense in [f64::NAN, f64::INFINITY] {
            let mut bad = good.clone();
            bad[offset..offset + 8].copy_from_slice(&nonsense.to_le_bytes());
            assert!(matches!(restored(&bad), Err(StateError::Invalid(_))), "{nonsense} at {offset}");
        }
    }
    assert!(found >= 6, "{found} outputs stand in the state as they are");
}
