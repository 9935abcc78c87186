//! Time-series figures as SVG, and a self-contained HTML report that carries them.
//!
//! Nothing here knows where the numbers come from: a [`Figure`] is panels of labelled series, a
//! [`Report`] is sections of text, tables and figures.
//!
//! ```
//! use videg_report::{Figure, Panel, Report, Section, Series, render_html, render_svg};
//!
//! let wave: Vec<(f64, f64)> = (0..=100).map(|k| f64::from(k) * 0.01).map(|t| (t, t.sin())).collect();
//! let figure = Figure::new("A wave")
//!     .panel(Panel::new("(a)", "time (s)", "amplitude (mm)").series(Series::points("wave", &wave)));
//! let svg = render_svg(&figure)?;
//!
//! let report = Report::new("One wave", "A sine over one second.")
//!     .section(Section::new("Result").figure(svg, "Amplitude against time."));
//! assert!(render_html(&report)?.starts_with("<!DOCTYPE html>"));
//! # Ok::<(), videg_report::ReportError>(())
//! ```

mod axes;
mod axis;
mod band;
mod canvas;
mod cells;
mod check;
mod clip;
mod colors;
mod contour;
mod draw;
mod drawing;
mod error;
mod figure;
mod html;
mod isolines;
mod labels;
mod layout;
mod legend;
mod marks;
mod metrics;
mod page;
mod plotly;
mod png;
mod policy;
mod reduce;
mod sankey;
mod svg;
mod table;
mod trace;

pub use drawing::Drawing;
pub use error::ReportError;
pub use figure::{Figure, HeatMap, Panel, Scale, Series, Style};
pub use html::render_html;
pub use page::{KeyNumber, Report, Section};
pub use png::render_png;
pub use policy::inert;
pub use sankey::{Kind, Sankey, Stage};
pub use svg::render_svg;
pub use table::{Cell, Column, Table, Tone};
