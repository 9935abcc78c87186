//! C(t) of a run, kept for many circuits.

use videg_circuit::Settings;
use videg_model::{Membrane, ModelError, Setup};

use crate::averages::{Averages, Gains};
use crate::mechanics::{Follower, Mechanics, Piece};
use crate::{CoupledError, Electrics, Results, Times, Watch};

/// Most knots that are kept: 32 bytes each, with the deflections, and 24 for each piece. 100 s of Fig. 14 have 27,000.
const MOST_KNOTS: usize = 1 << 19;

/// C(t) of a run as straight lines. Circuits that follow it have the results of [`run`](crate::run), to the last bit.
pub struct Track {
    times: Times,
    membrane: Membrane,
    averages: Averages,
    knots: Knots,
    /// Pieces up to the edges of the window.
    edges: [usize; 2],
}

#[derive(Default)]
struct Knots {
    /// Length, s; where its knots end; whether it is monotone.
    pieces: Vec<(f64, usize, bool)>,
    capacitances: Vec<[f64; 2]>,
    deflections: Vec<[f64; 2]>,
}

/// The knots are too many to be kept, or there is an error.
enum End {
    TooLong,
    Model(ModelError),
}

impl From<ModelError> for End {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}

impl Track {
    /// Records C(t) of the harvester of `setup`; none if it is too long to be kept.
    ///
    /// # Errors
    /// As [`run`](crate::run), but for the circuit.
    pub fn of<'a>(setup: impl Into<Setup<'a>>, times: &Times) -> Result<Option<Self>, CoupledError> {
        times.check()?;
        let mut mechanics = Mechanics::new(setup.into(), times.tolerance)?;
        let mut knots = Knots::default();
        let kept = knots.take(mechanics.start()).and_then(|()| knots.keep(&mut mechanics, times));
        let (gains, edges) = match kept {
            Ok(kept) => kept,
            Err(End::TooLong) => return Ok(None),
            Err(End::Model(error)) => return Err(error.into()),
        };
        knots.shrink();
        let averages = Averages::over(times.window, &gains[0], &gains[1]);
        let membrane = mechanics.harvester().membrane().clone();
        Ok(Some(Self { times: *times, membrane, averages, knots, edges }))
    }

    /// Runs a circuit of `settings`, while `watch` looks at the films.
    ///
    /// # Errors
    /// Parameters that the circuit refuses; more events than can be resolved.
    pub fn run(&self, settings: &Settings, watch: &mut dyn Watch) -> Result<Results, CoupledError> {
        watch.begin(&self.membrane);
        let mut electrics = Electrics::new(settings, self.knots.piece(0), watch)?;
        let mut ledgers = [electrics.circuit.ledger(); 2];
        for k in 1..self.knots.pieces.len() {
            electrics.take(self.knots.piece(k))?;
            for (ledger, _) in ledgers.iter_mut().zip(self.edges).filter(|(_, edge)| k + 1 == *edge) {
                *ledger = electrics.circuit.ledger();
            }
        }
        Ok(electrics.results(self.averages, self.times.window, ledgers))
    }
}

impl Knots {
    /// The whole run; the sums at the edges of the window, and the pieces up to there.
    fn keep(&mut self, mechanics: &mut Mechanics, times: &Times) -> Result<([Gains; 2], [usize; 2]), End> {
        let [from, to] = times.window;
        let before = (mechanics.follow(from, self)?, self.pieces.len());
        let after = (mechanics.follow(to, self)?, self.pieces.len());
        mechanics.follow(times.until, self)?;
        Ok(([before.0, after.0], [before.1, after.1]))
    }

    fn shrink(&mut self) {
        self.pieces.shrink_to_fit();
        self.capacitances.shrink_to_fit();
        self.deflections.shrink_to_fit();
    }

    fn piece(&self, k: usize) -> Piece<'_> {
        let (length, end, is_monotone) = self.pieces[k];
        let knots = k.checked_sub(1).map_or(0, |before| self.pieces[before].1)..end;
        Piece {
            length,
            capacitances: &self.capacitances[knots.clone()],
            deflections: &self.deflections[knots],
            is_monotone,
        }
    }
}

impl Follower for Knots {
    type Error = End;

    fn looks(&self) -> bool {
        true
    }

    fn needs_ends_only(&self, _: [f64; 2]) -> bool {
        false
    }

    fn take(&mut self, piece: Piece<'_>) -> Result<(), End> {
        self.capacitances.extend_from_slice(piece.capacitances);
        self.deflections.extend_from_slice(piece.deflections);
        self.pieces.push((piece.length, self.capacitances.len(), piece.is_monotone));
        if self.capacitances.len() > MOST_KNOTS { Err(End::TooLong) } else { Ok(()) }
    }
}
