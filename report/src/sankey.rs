//! Flows through a chain of stages, as bands whose widths are the flows: a Sankey diagram.
//!
//! A stage has sources on its left and sinks on its right, and may hand a flow on to the next stage. The order of all keeps bands from
//! crossing.

mod layout;

use askama::Template;

use super::error::ReportError;
use layout::Layout;

/// What a source or a sink is to the reader; it has a colour of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// What is put in.
    Given,
    /// What is wanted.
    Useful,
    /// What stays, to be had later.
    Stored,
    /// What becomes heat.
    Lost,
    /// What goes from stage to stage.
    Handed,
}

impl Kind {
    fn color(self) -> &'static str {
        match self {
            Self::Given => "#0072b2",
            Self::Useful => "#009e73",
            Self::Stored => "#cc79a7",
            Self::Lost => "#d55e00",
            Self::Handed => "#5a6b7b",
        }
    }
}

/// A source of a stage, or a sink if its flow is negative.
#[derive(Debug, Clone)]
struct Term {
    name: String,
    flow: f64,
    kind: Kind,
}

/// A part of a system with what it gets and what it gives.
#[derive(Debug, Clone)]
#[must_use]
pub struct Stage {
    name: String,
    terms: Vec<Term>,
    onward: f64,
}

impl Stage {
    /// A stage without flows.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), terms: Vec::new(), onward: 0.0 }
    }

    /// Adds a flow into the stage; a negative one goes out. One of 0, or one that is not known (NaN), is left out.
    pub fn gets(mut self, name: impl Into<String>, flow: f64, kind: Kind) -> Self {
        if flow.is_finite() && flow != 0.0 {
            self.terms.push(Term { name: name.into(), flow, kind });
        }
        self
    }

    /// Adds a flow out of the stage likewise.
    pub fn gives(self, name: impl Into<String>, flow: f64, kind: Kind) -> Self {
        self.gets(name, -flow, kind)
    }

    /// Sets the flow to the next stage; a negative one comes from there.
    pub fn hands_on(self, flow: f64) -> Self {
        Self { onward: if flow.is_finite() { flow } else { 0.0 }, ..self }
    }
}

/// A chain of stages.
#[derive(Debug, Clone)]
#[must_use]
pub struct Sankey {
    title: String,
    unit: String,
    stages: Vec<Stage>,
}

/// What goes into a stage, what comes out, and the difference.
#[derive(Debug, Clone, PartialEq)]
struct Balance {
    name: String,
    gets: f64,
    gives: f64,
}

impl Balance {
    fn residual(&self) -> f64 {
        self.gets - self.gives
    }

    /// The larger of what goes in and what comes out.
    fn through(&self) -> f64 {
        self.gets.max(self.gives)
    }

    fn words(&self, unit: &str) -> String {
        let (Self { name, gets, gives }, through) = (self, self.through());
        let relative = if through > 0.0 { self.residual().abs() / through } else { 0.0 };
        let (gets, gives) = (short(*gets), short(*gives));
        format!(
            "{name}: {gets} {unit} in, {gives} {unit} out; residual {:.1e} {unit}, {relative:.1e} of the flow",
            self.residual()
        )
    }
}

impl Sankey {
    /// A diagram without stages. The title is the accessible name; all flows have one unit.
    pub fn new(title: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { title: title.into(), unit: unit.into(), stages: Vec::new() }
    }

    /// Adds a stage behind the others.
    pub fn stage(mut self, stage: Stage) -> Self {
        self.stages.push(stage);
        self
    }

    /// Whether nothing flows.
    pub fn is_empty(&self) -> bool {
        self.balances().iter().all(|balance| balance.gets == 0.0 && balance.gives == 0.0)
    }

    fn balances(&self) -> Vec<Balance> {
        let mut handed = 0.0;
        let balance = |stage: &Stage| {
            let flows = stage.terms.iter().map(|term| term.flow).chain([handed, -stage.onward]);
            handed = stage.onward;
            let (gets, gives) =
                flows.fold((0.0, 0.0), |(gets, gives), flow| (gets + flow.max(0.0), gives - flow.min(0.0)));
            Balance { name: stage.name.clone(), gets, gives }
        };
        self.stages.iter().map(balance).collect()
    }

    /// The diagram as an SVG document, 720 px wide.
    ///
    /// # Errors
    /// If the template engine refuses.
    pub fn render(&self) -> Result<String, ReportError> {
        let layout = Layout::of(self);
        let document = Document { title: &self.title, unit: &self.unit, layout: &layout, balances: &self.balances() };
        Ok(document.render()?)
    }
}

#[derive(Template)]
#[template(path = "sankey.svg", escape = "html")]
struct Document<'a> {
    title: &'a str,
    unit: &'a str,
    layout: &'a Layout,
    balances: &'a [Balance],
}

impl Document<'_> {
    /// The balances below the diagram: where they stand, px, and their words.
    fn lines(&self) -> impl Iterator<Item = (f64, String)> + '_ {
        let line = |(index, balance): (usize, &Balance)| {
            (self.layout.height + 16.0 * (index as f64 + 1.0), balance.words(self.unit))
        };
        self.balances.iter().enumerate().map(line)
    }

    fn height(&self) -> f64 {
        self.layout.height + 16.0 * self.balances.len() as f64 + 12.0
    }
}

/// Four significant digits.
fn short(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if value == 0.0 {
        "0".to_owned()
    } else if (-3.0..7.0).contains(&exponent) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 6")]
        let decimals = (3.0 - exponent).max(0.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_four_digits() {
        let shown = [0.0, 1234.5678, 0.012_345, 99.999_9, 1e-9, 12_345_678.0].map(short);
        assert_eq!(shown, ["0", "1235", "0.01235", "100.00", "1.00e-9", "1.23e7"]);
    }

    #[test]
    fn a_document_names_flows_and_residual_and_escapes_names() {
        let ball = Stage::new("ball").gets("walls", 3.0, Kind::Given).gives("<lost>", 1.0, Kind::Lost).hands_on(2.0);
        let circuit = Stage::new("circuit").gets("supply", 1.0, Kind::Given).gives("load", 2.5, Kind::Useful);
        let svg = Sankey::new("Energy & more", "mW").stage(ball).stage(circuit).render().unwrap();
        for part in ["Energy &#38; more", "&#60;lost&#62;", "2.500 mW", "residual 5.0e-1 mW, 1.7e-1 of the flow"] {
            assert!(svg.contains(part), "{part}: {svg}");
        }
        assert_eq!(svg.matches("data-flow=").count(), 5);
    }

    #[test]
    fn nothing_is_empty_and_unknown_flows_are_left_out() {
        let stage = Stage::new("circuit").gets("supply", 0.0, Kind::Given).gives("Zener", f64::NAN, Kind::Lost);
        let sankey = Sankey::new("", "W").stage(stage);
        assert!(sankey.is_empty() && !sankey.render().unwrap().contains("NaN"));
    }
}
