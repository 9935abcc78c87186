//! A raw file, as ngspice or something that calls itself so left it.
#![no_main]

use videg::ngspice::RawReader;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(mut reader) = RawReader::new(bytes) else { return };
    let width = reader.names().len();
    let (mut values, mut points) = (Vec::new(), 0);
    while let Ok(true) = reader.next_point(&mut values) {
        assert_eq!(values.len(), width);
        assert!(values.iter().all(|value| value.is_finite()));
        points += 1;
    }
    assert!(points <= reader.points());
    assert!(points as usize * width * 8 <= bytes.len(), "points from nowhere");
});
