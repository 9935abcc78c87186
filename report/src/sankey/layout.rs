//! Places of the nodes and bands of a Sankey diagram, px.

use super::{Balance, Kind, Sankey, Stage, Term};

const WIDTH: f64 = 720.0;
const EDGE: f64 = 14.0;
/// Width of a node.
const BAR: f64 = 11.0;
/// Height of the flows of the fullest column.
const FLOWS: f64 = 200.0;
/// Room for name and value above a node.
const LABEL: f64 = 32.0;
const GAP: f64 = 12.0;
/// Distance of the last two columns, in that of the others.
const LAST: f64 = 1.6;
/// The smallest flow that is drawn, over the largest. The balances have those below it, too.
const SEEN: f64 = 1e-8;

/// A source, a stage or a sink.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub name: String,
    pub kind: Kind,
    pub flow: f64,
    pub x: f64,
    pub y: f64,
    pub height: f64,
    /// Whether its label ends at its right edge.
    pub is_last: bool,
}

/// A flow from node to node.
#[derive(Debug, Clone)]
pub(super) struct Band {
    pub flow: f64,
    pub kind: Kind,
    /// Number of the stage that it leaves, and of the one that it enters.
    pub stages: [Option<usize>; 2],
    /// Upper left and upper right corner.
    pub from: (f64, f64),
    pub to: (f64, f64),
    pub width: f64,
    pub names: [String; 2],
}

impl Band {
    /// The outline.
    pub fn path(&self) -> String {
        let ((x0, y0), (x1, y1), middle) = (self.from, self.to, f64::midpoint(self.from.0, self.to.0));
        let (b0, b1) = (y0 + self.width, y1 + self.width);
        format!(
            "M{x0:.1},{y0:.2}C{middle:.1},{y0:.2} {middle:.1},{y1:.2} {x1:.1},{y1:.2}V{b1:.2}C{middle:.1},{b1:.2} {middle:.1},{b0:.2} \
             {x0:.1},{b0:.2}Z"
        )
    }
}

/// All places.
#[derive(Debug, Clone, Default)]
pub(super) struct Layout {
    pub nodes: Vec<Node>,
    pub bands: Vec<Band>,
    pub height: f64,
}

/// What a column holds.
enum Entry<'a> {
    Source(usize, &'a str, f64, Kind),
    Stage(usize),
    Sink(usize, &'a str, f64, Kind),
}

/// A source or sink of a stage that is placed, and whose band is not drawn yet.
struct Leaf {
    stage: usize,
    is_source: bool,
    /// Upper corner of the side at which the band ends.
    at: (f64, f64),
    /// Number of its node.
    node: usize,
}

/// A layout in the making.
struct Placing<'a> {
    stages: &'a [Stage],
    balances: Vec<Balance>,
    /// Height of a flow of 1.
    scale: f64,
    /// Where the next band that enters each stage ends, and where the next one that leaves it begins.
    ports: Vec<[(f64, f64); 2]>,
    leaves: Vec<Leaf>,
    layout: Layout,
}

impl Layout {
    /// Sources of a stage stand in the column before it, its sinks in the one behind it.
    pub fn of(sankey: &Sankey) -> Self {
        let (stages, balances) = (&sankey.stages[..], sankey.balances());
        let largest = balances.iter().map(Balance::through).fold(0.0, f64::max);
        let columns: Vec<_> = (0..stages.len() + 2).map(|column| entries(stages, column, SEEN * largest)).collect();
        let flows = |column: &Vec<Entry<'_>>| column.iter().map(|entry| entry.flow(&balances)).sum::<f64>();
        let fullest = columns.iter().map(flows).fold(0.0, f64::max);
        let scale = if fullest > 0.0 { FLOWS / fullest } else { 0.0 };
        let (ports, leaves) = (vec![[(0.0, 0.0); 2]; stages.len()], Vec::new());
        let mut placing = Placing { stages, balances, scale, ports, leaves, layout: Self::default() };
        // Labels of the last column run to the left, those of the one before it to the right.
        let pitch = (WIDTH - 2.0 * EDGE - BAR) / (columns.len() as f64 - 2.0 + LAST);
        for (column, entries) in columns.iter().enumerate() {
            let is_last = column + 1 == columns.len();
            placing.column(entries, if is_last { WIDTH - EDGE - BAR } else { EDGE + pitch * column as f64 }, is_last);
        }
        placing.join()
    }
}

impl Placing<'_> {
    /// Places the nodes of a column, whose left edge is at `x`.
    fn column(&mut self, entries: &[Entry<'_>], x: f64, is_last: bool) {
        let mut y = 0.0;
        for entry in entries {
            y += LABEL;
            let node = self.layout.nodes.len();
            let (name, kind) = match *entry {
                Entry::Source(stage, name, _, kind) => {
                    self.leaves.push(Leaf { stage, is_source: true, at: (x + BAR, y), node });
                    (name, kind)
                }
                Entry::Sink(stage, name, _, kind) => {
                    self.leaves.push(Leaf { stage, is_source: false, at: (x, y), node });
                    (name, kind)
                }
                Entry::Stage(stage) => {
                    self.ports[stage] = [(x, y), (x + BAR, y)];
                    (self.stages[stage].name.as_str(), Kind::Handed)
                }
            };
            let flow = entry.flow(&self.balances);
            let height = self.scale * flow;
            self.layout.nodes.push(Node { name: name.to_owned(), kind, flow, x, y, height, is_last });
            y += height.max(1.0) + GAP;
        }
        self.layout.height = self.layout.height.max(y);
    }

    /// Bands from top to bottom at both sides of each stage: those from its sources before that of the stage before it, that to the next
    /// stage before those to its sinks.
    fn join(mut self) -> Layout {
        let (sources, sinks): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.leaves).into_iter().partition(|leaf| leaf.is_source);
        for leaf in sources {
            self.join_leaf(&leaf);
        }
        for (stage, pair) in self.stages.windows(2).enumerate().filter(|(_, pair)| pair[0].onward > 0.0) {
            let (flow, width) = (pair[0].onward, self.scale * pair[0].onward);
            let (from, to) = (self.take(stage, 1, width), self.take(stage + 1, 0, width));
            let names = [pair[0].name.clone(), pair[1].name.clone()];
            let stages = [Some(stage), Some(stage + 1)];
            self.layout.bands.push(Band { flow, kind: Kind::Handed, stages, from, to, width, names });
        }
        for leaf in sinks {
            self.join_leaf(&leaf);
        }
        self.layout
    }

    /// The band between a stage and its source or sink.
    fn join_leaf(&mut self, leaf: &Leaf) {
        let &Leaf { stage, is_source, at, node } = leaf;
        let Node { flow, kind, name, height: width, .. } = self.layout.nodes[node].clone();
        let (own, port) = (self.stages[stage].name.clone(), self.take(stage, usize::from(!is_source), width));
        let (stages, names, from, to) = if is_source {
            ([None, Some(stage)], [name, own], at, port)
        } else {
            ([Some(stage), None], [own, name], port, at)
        };
        self.layout.bands.push(Band { flow, kind, stages, from, to, width, names });
    }

    /// The next place for a band of this width at a side of a stage: 0 where bands enter, 1 where they leave.
    fn take(&mut self, stage: usize, side: usize, width: f64) -> (f64, f64) {
        let port = &mut self.ports[stage][side];
        let place = *port;
        port.1 += width;
        place
    }
}

impl Entry<'_> {
    /// The flow that its height shows.
    fn flow(&self, balances: &[Balance]) -> f64 {
        match self {
            Self::Source(_, _, flow, _) | Self::Sink(_, _, flow, _) => *flow,
            Self::Stage(stage) => balances[*stage].through(),
        }
    }
}

fn entries(stages: &[Stage], column: usize, least: f64) -> Vec<Entry<'_>> {
    let is_source = move |term: &&Term| term.flow > least;
    let sources = stages.get(column).into_iter().flat_map(move |stage| stage.terms.iter().filter(is_source));
    let mut found: Vec<_> =
        sources.map(|term| Entry::Source(column, term.name.as_str(), term.flow, term.kind)).collect();
    // A flow back from the next stage ends at both as a leaf: bands run from left to right.
    if let Some([stage, next]) =
        stages.get(column..column + 2).filter(|pair| pair[0].onward < 0.0).map(|pair| [&pair[0], &pair[1]])
    {
        found.push(Entry::Source(column, next.name.as_str(), -stage.onward, Kind::Handed));
    }
    if column > 0 && column <= stages.len() {
        found.push(Entry::Stage(column - 1));
    }
    let Some(sunk) = column.checked_sub(2).filter(|index| *index < stages.len()) else { return found };
    if let Some(before) = sunk.checked_sub(1).map(|index| &stages[index]).filter(|before| before.onward < 0.0) {
        found.push(Entry::Sink(sunk, before.name.as_str(), -before.onward, Kind::Handed));
    }
    let sinks = stages[sunk].terms.iter().filter(|term| -term.flow > least);
    found.extend(sinks.map(|term| Entry::Sink(sunk, term.name.as_str(), -term.flow, term.kind)));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Flows of any sign and size, some of them 0.
    fn flow() -> impl Strategy<Value = f64> {
        prop_oneof![Just(0.0), -1e3..1e3, (-9.0..6.0).prop_map(|exponent| 10_f64.powf(exponent))]
    }

    fn chain() -> impl Strategy<Value = Vec<(Vec<f64>, f64)>> {
        prop::collection::vec((prop::collection::vec(flow(), 0..6), flow()), 1..5)
    }

    fn sankey(chain: &[(Vec<f64>, f64)]) -> Sankey {
        chain.iter().enumerate().fold(Sankey::new("", "W"), |sankey, (number, (flows, onward))| {
            let stage = flows.iter().fold(Stage::new("stage"), |stage, flow| stage.gets("flow", *flow, Kind::Given));
            sankey.stage(if number + 1 < chain.len() { stage.hands_on(*onward) } else { stage })
        })
    }

    proptest! {
        #[test]
        fn bands_of_a_stage_sum_to_its_balance_and_none_is_negative(chain in chain()) {
            let layout = Layout::of(&sankey(&chain));
            prop_assert!(layout.bands.iter().all(|band| band.flow > 0.0 && band.width >= 0.0));
            for (stage, (flows, onward)) in chain.iter().enumerate() {
                let before = if stage > 0 { chain[stage - 1].1 } else { 0.0 };
                let onward = if stage + 1 < chain.len() { *onward } else { 0.0 };
                let expected: f64 = flows.iter().sum::<f64>() + before - onward;
                let of = |side: usize| layout.bands.iter().filter(move |band| band.stages[side] == Some(stage));
                let (gets, gives): (f64, f64) = (of(1).map(|band| band.flow).sum(), of(0).map(|band| band.flow).sum());
                let all: f64 = chain.iter().flat_map(|(flows, onward)| flows.iter().chain([onward])).map(|flow| flow.abs()).sum();
                prop_assert!((gets - gives - expected).abs() <= 10.0 * SEEN * all, "{gets} - {gives}, not {expected}");
                // All bands have one scale, and lie within their stage without a gap.
                let height = layout.nodes.iter().filter(|node| node.name == "stage" && node.kind == Kind::Handed);
                let tallest = height.map(|node| node.height).fold(0.0, f64::max);
                for side in [0, 1] {
                    let width: f64 = of(side).map(|band| band.width).sum();
                    prop_assert!(width <= tallest * (1.0 + 1e-12));
                }
            }
        }

        #[test]
        fn nodes_of_a_column_do_not_overlap_and_bands_end_at_nodes(chain in chain()) {
            let layout = Layout::of(&sankey(&chain));
            for pair in layout.nodes.windows(2).filter(|pair| pair[0].x == pair[1].x) {
                prop_assert!(pair[1].y >= pair[0].y + pair[0].height + GAP);
            }
            for node in &layout.nodes {
                prop_assert!(node.x >= 0.0 && node.x + BAR <= WIDTH && node.y >= LABEL && node.y + node.height <= layout.height);
            }
            for band in &layout.bands {
                let meets = |(x, y): (f64, f64), at: f64| layout.nodes.iter().any(|node| {
                    (node.x + at - x).abs() < 1e-9 && node.y <= y + 1e-9 && y + band.width <= node.y + node.height + 1e-9
                });
                prop_assert!(meets(band.from, BAR) && meets(band.to, 0.0));
            }
        }
    }
}
