//! Copies of a contact. `clone_from` takes no memory that is there already, as [`crate::Harvester`] promises.

use super::{Pass, Touch};

impl Clone for Pass {
    fn clone(&self) -> Self {
        Self { steps: self.steps.clone(), ..*self }
    }

    fn clone_from(&mut self, source: &Self) {
        let Self { ref steps, end, ending } = *source;
        self.steps.clone_from(steps);
        (self.end, self.ending) = (end, ending);
    }
}

impl Clone for Touch {
    fn clone(&self) -> Self {
        Self { pass: self.pass.clone(), ..*self }
    }

    fn clone_from(&mut self, source: &Self) {
        let Self { side, since, phase, largest, start, credited, proposal, ref pass } = *source;
        self.pass.clone_from(pass);
        (self.side, self.phase, self.start) = (side, phase, start);
        (self.since, self.largest, self.credited, self.proposal) = (since, largest, credited, proposal);
    }
}
