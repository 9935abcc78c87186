//! Exact solution with ideal elements: closed forms between switching instants, each instant located inside
//! the step. There is no internal step, so that none can be skipped.

use crate::network::{NOISE, Network};
use crate::parameters::Release;
use crate::release::{Discharge, Span};
use crate::roots::Curve;
use crate::state::{Mode, Node};

/// Bound on the switching instants in one step; a pair of linear ramps has a handful.
pub(crate) const EVENTS: usize = 64;

/// Relative distance from a switching instant at which none is looked for.
const MARGIN: f64 = 1e-9;

/// What happens at a switching instant.
#[derive(Debug, Clone, Copy)]
enum Event {
    /// Node falls to `U_in`: the charging diode conducts.
    Supply(usize),
    /// Node rises to the voltage of release.
    Threshold(usize),
    /// Blocked node meets the node that leads.
    Meet(usize),
    /// Own current of one of two joined nodes falls to zero.
    Block(usize),
    /// The releasing nodes fall to `U_z`.
    Fall,
    /// The elements that hold a leaking node do so no longer; what follows, [`Network::settle`] decides.
    Leave,
}

impl Network {
    /// Advances by `dt` > 0 with capacitances linear in time up to `ends`. `None` when [`EVENTS`] is exceeded.
    pub fn advance(&mut self, dt: f64, ends: [f64; 2]) -> Option<()> {
        for (node, end) in self.nodes.iter_mut().zip(ends) {
            node.rate = (end - node.capacitance) / dt;
        }
        if self.nodes.iter().any(|node| !node.rate.is_finite()) {
            // A ramp too steep for its slope to be a number is a jump.
            self.jump(ends);
            return Some(());
        }
        let mut remaining = dt;
        self.change(Self::settle);
        for _ in 0..EVENTS {
            let discharge = self.discharge().map(|leader| (leader, leader.span(remaining)));
            let Some((t, event)) = self.next_event(remaining, discharge) else {
                self.flow(remaining, ends, discharge);
                return Some(());
            };
            let discharge = discharge.map(|(leader, _)| (leader, leader.span(t)));
            self.flow(t, self.nodes.map(|node| node.capacitance + node.rate * t), discharge);
            remaining -= t;
            self.change(|network| {
                network.apply(event);
                network.settle();
            });
        }
        None
    }

    /// Runs `action` and counts the nodes whose mode it changed.
    fn change(&mut self, action: impl FnOnce(&mut Self)) {
        let before = self.nodes.map(|node| node.mode);
        action(self);
        let changed = (0..self.count).filter(|&j| self.nodes[j].mode != before[j]);
        self.events += changed.count() as u64;
    }

    /// The first switching instant within `span` seconds, in which the releasing nodes have this `discharge` if there is none.
    fn next_event(&self, span: f64, discharge: Option<(Discharge, Span)>) -> Option<(f64, Event)> {
        let leaks = self.elements.leak > 0.0;
        let threshold = self.elements.threshold;
        // Without a leak the load voltage is monotonic: mostly its least value tells that nothing happens.
        let lowest = discharge.filter(|_| !leaks).map_or(0.0, |(leader, whole)| least(leader.excess, whole.excess));
        let discharge = discharge.map(|(leader, _)| leader);
        let fall = discharge.and_then(|leader| {
            if leaks {
                return leader.time_to_leak_to(threshold, span);
            }
            let is_above = lowest + leader.drop - threshold > MARGIN * leader.excess;
            if is_above { None } else { leader.time_to_fall_to(threshold) }
        });
        // Beyond it, leaking nodes may have lost so much that nothing is left to compare.
        let falls = if leaks { fall.unwrap_or(span) } else { span };
        let joined = self.in_mode(Mode::Releasing).count() == 2;
        let mut first: Option<(f64, Event)> = None;
        let mut offer = |t: Option<f64>, event: Event| {
            let bound = first.map_or(span, |(earliest, _)| earliest);
            if let Some(t) = t.map(|t| t.max(0.0)).filter(|t| *t < bound) {
                first = Some((t, event));
            }
        };
        for j in 0..self.count {
            match (self.nodes[j].mode, &discharge) {
                (Mode::Off, leader) => {
                    offer(self.time_to_supply(j, span), Event::Supply(j));
                    match leader {
                        Some(leader) if !leaks && self.stays_blocked(j, lowest + leader.drop, span) => {}
                        Some(leader) => offer(self.time_to_meet(j, leader, falls), Event::Meet(j)),
                        None => offer(self.time_to_threshold(j, span), Event::Threshold(j)),
                    }
                }
                (Mode::Charging, _) if leaks => offer(self.time_to_leave(j, span), Event::Leave),
                (Mode::Releasing, Some(pair)) if joined => {
                    offer(self.time_to_block(j, pair, falls), Event::Block(j));
                }
                _ => {}
            }
        }
        offer(fall, Event::Fall);
        if leaks && discharge.is_none() {
            offer(self.time_to_overrun(span), Event::Leave);
        }
        first
    }

    fn time_to_supply(&self, j: usize, span: f64) -> Option<f64> {
        let node = &self.nodes[j];
        if self.elements.leak > 0.0 {
            return self.time_to_leak_to(node, self.elements.supply, span);
        }
        (node.rate > 0.0).then(|| time_to_voltage(node, self.elements.supply))
    }

    fn time_to_threshold(&self, j: usize, span: f64) -> Option<f64> {
        let node = &self.nodes[j];
        if self.elements.leak > 0.0 && !self.elements.open() {
            return self.time_to_rise_to(node, self.elements.threshold, span);
        }
        (node.rate < 0.0 && !self.elements.open()).then(|| time_to_voltage(node, self.elements.threshold))
    }

    /// Whether the charge of node `j` stays clearly below what it would be at the least voltage of the leader within
    /// `span` seconds. NaN never does.
    fn stays_blocked(&self, j: usize, lowest: f64, span: f64) -> bool {
        let node = &self.nodes[j];
        least(node.capacitance, node.capacitance + node.rate * span) * lowest > node.charge * (1.0 + MARGIN)
    }

    /// When the blocked node `j` reaches the voltage of the leader, that is when `h = C_j V_leader - Q_j`
    /// falls through zero. `h` is a combination of four powers of the leader's capacitance, `h''` of two: it
    /// has one zero, in closed form.
    fn time_to_meet(&self, j: usize, leader: &Discharge, span: f64) -> Option<f64> {
        if self.elements.leak > 0.0 {
            return self.time_to_meet_leaking(j, leader, span);
        }
        let node = self.nodes[j];
        let capacitance = |t: f64| node.capacitance + node.rate * t;
        let decay = leader.rate + leader.conductance;
        // h'' is proportional to C_j (a + k) - 2 k_j C, linear in time.
        let at_start = node.capacitance * (decay + leader.rate) - 2.0 * node.rate * leader.capacitance;
        let slope = node.rate * (decay - leader.rate);
        Curve {
            value: |t: f64| {
                let level = capacitance(t) * (leader.drop + leader.excess_at(t));
                (level - node.charge, level)
            },
            slopes: |t: f64| {
                // -i_j C_j of the joined pair, so that the sign agrees with the decision to block.
                let first = -self.share(j, leader, t).0 / leader.capacitance_at(t);
                let second = 2.0 * node.rate * leader.slope_at(t) + capacitance(t) * leader.curvature_at(t);
                (first, second)
            },
            inflection: -at_start / slope,
        }
        .first_descent(span, NOISE)
    }

    /// When the own current of node `j` of a joined pair falls to zero; the same kind of function as in
    /// [`Self::time_to_meet`].
    fn time_to_block(&self, j: usize, pair: &Discharge, span: f64) -> Option<f64> {
        let node = self.nodes[j];
        let (g, lead) = (pair.conductance, self.lead(j));
        if lead >= 0.0 {
            return None;
        }
        if self.elements.leak > 0.0 {
            return self.time_to_block_leaking(j, pair, span);
        }
        let factor = |t: f64| (node.capacitance + node.rate * t) * g + lead;
        let decay = pair.rate + g;
        // The second derivative is proportional to (C_j / R + lead) (a + k) - 2 k_j C / R.
        let at_start = factor(0.0) * (decay + pair.rate) - 2.0 * g * node.rate * pair.capacitance;
        let slope = g * node.rate * (decay - pair.rate);
        Curve {
            value: |t: f64| self.share(j, pair, t),
            slopes: |t: f64| {
                let w_slope = pair.slope_at(t);
                let first = g * node.rate * pair.excess_at(t) + factor(t) * w_slope;
                let second = 2.0 * g * node.rate * w_slope + factor(t) * pair.curvature_at(t);
                (first, second)
            },
            inflection: -at_start / slope,
        }
        .first_descent(span, NOISE)
    }

    fn apply(&mut self, event: Event) {
        match event {
            Event::Supply(j) => self.pin(j, self.elements.supply, Mode::Charging),
            Event::Threshold(j) => self.pin(j, self.elements.threshold, Mode::Holding),
            Event::Meet(j) => self.nodes[j].mode = Mode::Releasing,
            Event::Block(j) => self.nodes[j].mode = Mode::Off,
            Event::Leave => {}
            Event::Fall => {
                for j in 0..self.count {
                    if self.nodes[j].mode == Mode::Releasing {
                        self.pin(j, self.elements.threshold, Mode::Holding);
                    }
                }
            }
        }
    }

    /// Puts a node exactly at the voltage that it reached up to rounding.
    fn pin(&mut self, j: usize, voltage: f64, mode: Mode) {
        self.nodes[j].charge = voltage * self.nodes[j].capacitance;
        self.nodes[j].mode = mode;
    }

    /// Capacitances go to `ends` at once. No finite current moves charge meanwhile: charge is conserved, but
    /// for what the ideal diode delivers at `U_in` and what a load of 0 ohm or a storage takes at the
    /// voltage of release, both as along a quick ramp.
    pub fn jump(&mut self, ends: [f64; 2]) {
        self.change(|network| {
            for (j, end) in ends.into_iter().enumerate().take(network.count) {
                network.jump_node(j, end);
            }
            network.rank();
        });
    }

    fn jump_node(&mut self, j: usize, end: f64) {
        let node = self.nodes[j];
        self.nodes[j].rate = 0.0;
        if end == node.capacitance {
            return;
        }
        let rises = end > node.capacitance;
        if rises && node.charge <= self.elements.supply * end {
            let corner = (node.charge / self.elements.supply).max(node.capacitance);
            self.coast(j, corner);
            self.inrush(j);
            self.charge(j, end);
            self.nodes[j].mode = Mode::Charging;
        } else if !rises && self.elements.short() && node.charge >= self.elements.threshold * end {
            let corner = (node.charge / self.elements.threshold).min(node.capacitance);
            self.coast(j, corner);
            self.outrush(j);
            self.hold(j, end);
            self.nodes[j].mode = Mode::Holding;
        } else {
            self.coast(j, end);
            if node.mode != Mode::Releasing {
                self.nodes[j].mode = Mode::Off;
            }
        }
    }

    /// A node below `U_in` is filled at once; the ideal diode burns what the supply gives too much.
    pub fn inrush(&mut self, j: usize) {
        let supply = self.elements.supply;
        let node = &mut self.nodes[j];
        let missing = supply * node.capacitance - node.charge;
        if missing <= 0.0 {
            return;
        }
        self.ledger.supply_charge += missing;
        self.ledger.supply += supply * missing;
        self.ledger.diode += 0.5 * missing * (supply - node.voltage());
        node.charge = supply * node.capacitance;
        node.mode = Mode::Charging;
    }

    /// A node above the voltage of release is emptied down to it at once: into a load of 0 ohm, the limit of a small
    /// one, or into a storage, where the ideal diode burns what is above `U_out`.
    pub fn outrush(&mut self, j: usize) {
        let threshold = self.elements.threshold;
        let node = &mut self.nodes[j];
        let surplus = node.charge - threshold * node.capacitance;
        if surplus <= 0.0 || !self.elements.short() {
            return;
        }
        let above = 0.5 * surplus * (node.voltage() - threshold);
        node.charge = threshold * node.capacitance;
        node.mode = Mode::Holding;
        match self.elements.release {
            Release::Zener | Release::Switch => self.ledger.load += above,
            Release::Storage => self.ledger.diode += above,
        }
        self.release_at_threshold(surplus);
    }

    /// After a jump, or at the start: of the nodes above `U_z` the highest leads.
    pub fn rank(&mut self) {
        if self.elements.open() || self.elements.short() {
            return;
        }
        let top = self.nodes[..self.count].iter().map(Node::voltage).fold(0.0, f64::max);
        if top > self.elements.threshold {
            self.excess = top - self.elements.drop;
        }
        for node in &mut self.nodes[..self.count] {
            let above = node.voltage() > self.elements.threshold * (1.0 + NOISE);
            let leads = above && node.voltage() >= top * (1.0 - NOISE);
            node.mode = match node.mode {
                _ if leads => Mode::Releasing,
                Mode::Releasing => Mode::Off,
                Mode::Holding if top > self.elements.threshold * (1.0 + NOISE) => Mode::Off,
                mode => mode,
            };
        }
    }
}

fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// When a node of constant charge reaches a voltage, on a ramp that leads there.
fn time_to_voltage(node: &Node, voltage: f64) -> f64 {
    (node.charge / voltage - node.capacitance) / node.rate
}
