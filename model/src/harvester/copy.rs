//! Copies. Masters that try steps save a harvester and take it back at each of them: `clone_from` takes no memory that is
//! there already, and moves what it copies once.

use super::Harvester;

impl Clone for Harvester {
    fn clone(&self) -> Self {
        Self { holds: self.holds.clone(), pulses: self.pulses.clone(), touch: self.touch.clone(), ..*self }
    }

    fn clone_from(&mut self, source: &Self) {
        macro_rules! take_over {
            ($($copied:ident)*; $($cloned:ident)*) => {
                let Self { $($copied,)* $($cloned,)* } = source; // all fields
                $(self.$copied = *$copied;)*
                $(self.$cloned.clone_from($cloned);)*
            };
        }
        take_over! {
            parameters membrane shape time cylinder ball noise search voltages totals ledger tangent placed calm_until second
            second_events;
            holds pulses touch
        }
    }
}
