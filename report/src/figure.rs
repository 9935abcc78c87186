//! Content of a figure: panels, series, reference lines.

/// Panels, rendered by [`render_svg`](super::render_svg).
#[derive(Debug, Clone, Default)]
#[must_use]
pub struct Figure<'a> {
    pub(super) title: String,
    pub(super) caption: String,
    pub(super) width: f64,
    pub(super) columns: usize,
    /// Row by row, from left to right.
    pub(super) panels: Vec<Panel<'a>>,
}

impl<'a> Figure<'a> {
    /// A figure without panels, 720 px wide. The title stands above the panels and is the accessible name; an empty one takes no
    /// space.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), width: 720.0, columns: 1, ..Self::default() }
    }

    /// Sets the long description for screen readers, which is not drawn.
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Self { caption: caption.into(), ..self }
    }

    /// Puts `columns` panels side by side.
    pub fn columns(self, columns: usize) -> Self {
        Self { columns, ..self }
    }

    /// Sets the nominal width in px; the SVG scales with its container.
    pub fn width(self, width: f64) -> Self {
        Self { width, ..self }
    }

    /// Adds a panel behind the others.
    pub fn panel(mut self, panel: Panel<'a>) -> Self {
        self.panels.push(panel);
        self
    }
}

/// One pair of axes with its series.
#[derive(Debug, Clone, Default)]
#[expect(clippy::struct_excessive_bools, reason = "independent properties, each with a builder of its own")]
#[must_use]
pub struct Panel<'a> {
    pub(super) title: String,
    pub(super) x_label: String,
    pub(super) y_label: String,
    pub(super) x_names: Vec<(f64, String)>,
    pub(super) x_range: Option<(f64, f64)>,
    pub(super) y_range: Option<(f64, f64)>,
    pub(super) share_x_with_next: bool,
    pub(super) height: f64,
    pub(super) series: Vec<Series<'a>>,
    pub(super) lines: Vec<ReferenceLine>,
    pub(super) bands: Vec<Band<'a>>,
    pub(super) bars: Vec<Bars<'a>>,
    pub(super) map: Option<HeatMap<'a>>,
    pub(super) contours: bool,
    pub(super) hatches: Vec<Hatch<'a>>,
    pub(super) log_x: bool,
    pub(super) log_y: bool,
    pub(super) equal_aspect: bool,
}

impl<'a> Panel<'a> {
    /// A panel of 130 px without series. The title, such as `(a)`, stands at the upper left; labels name quantity and unit. An
    /// empty text takes no space.
    pub fn new(title: impl Into<String>, x_label: impl Into<String>, y_label: impl Into<String>) -> Self {
        Self { title: title.into(), x_label: x_label.into(), y_label: y_label.into(), height: 130.0, ..Self::default() }
    }

    /// Sets the ends of the x axis, which otherwise spans the data.
    pub fn x_range(self, low: f64, high: f64) -> Self {
        Self { x_range: Some((low, high)), ..self }
    }

    /// Names places on the x axis, which then has no numbers; for a linear axis.
    pub fn x_names<S: Into<String>>(self, names: impl IntoIterator<Item = (f64, S)>) -> Self {
        Self { x_names: names.into_iter().map(|(x, name)| (x, name.into())).collect(), ..self }
    }

    /// Sets the ends of the y axis, which otherwise spans the data within the x range, and the reference lines.
    pub fn y_range(self, low: f64, high: f64) -> Self {
        Self { y_range: Some((low, high)), ..self }
    }

    /// Sets the height of the frame in px, without labels.
    pub fn height(self, height: f64) -> Self {
        Self { height, ..self }
    }

    /// Takes the same x axis as the panel below in the same column, which alone carries its tick labels.
    pub fn share_x_with_next(self) -> Self {
        Self { share_x_with_next: true, ..self }
    }

    /// Adds a series; its colour is the next one of the palette.
    pub fn series(mut self, mut series: Series<'a>) -> Self {
        series.color = series.color.or(Some(self.series.len()));
        self.series.push(series);
        self
    }

    /// Adds a dashed horizontal line; an empty label keeps it out of the legend.
    pub fn line(mut self, label: impl Into<String>, value: f64) -> Self {
        self.lines.push(ReferenceLine { label: label.into(), value });
        self
    }

    /// Adds the area between two curves, below the series, in the colour of palette entry `color`; an empty label keeps it out of
    /// the legend.
    pub fn band(mut self, label: impl Into<String>, limits: &'a [(f64, f64, f64)], color: usize) -> Self {
        self.bands.push(Band { label: label.into(), limits, color });
        self
    }

    /// Adds vertical bars, such as confidence intervals, in the colour of palette entry `color`.
    pub fn bars(mut self, limits: &'a [(f64, f64, f64)], color: usize) -> Self {
        self.bars.push(Bars { limits, color });
        self
    }

    /// Sets the map, which is drawn below everything else.
    pub fn map(self, map: HeatMap<'a>) -> Self {
        Self { map: Some(map), ..self }
    }

    /// Draws labelled lines of equal value over the map of a quantity, at the ticks of its colour bar.
    pub fn contours(self) -> Self {
        Self { contours: true, ..self }
    }

    /// Hatches the part of the map where another quantity is above a bound: `values` has one of it for each cell, in their order. An empty
    /// label keeps it out of the legend.
    pub fn hatched(mut self, label: impl Into<String>, values: &'a [f64], above: f64) -> Self {
        self.hatches.push(Hatch { label: label.into(), values, above });
        self
    }

    /// Makes the x axis logarithmic: values of 0 and below leave a gap.
    pub fn log_x(self) -> Self {
        Self { log_x: true, ..self }
    }

    /// Makes the y axis logarithmic, likewise.
    pub fn log_y(self) -> Self {
        Self { log_y: true, ..self }
    }

    /// Draws x and y to one scale: the height follows from the ranges.
    pub fn equal_aspect(self) -> Self {
        Self { equal_aspect: true, ..self }
    }
}

/// The area between two curves.
#[derive(Debug, Clone)]
pub(super) struct Band<'a> {
    pub label: String,
    /// x, lower and upper y, by ascending x.
    pub limits: &'a [(f64, f64, f64)],
    pub color: usize,
}

/// A part of a map.
#[derive(Debug, Clone)]
pub(super) struct Hatch<'a> {
    pub label: String,
    /// One a cell.
    pub values: &'a [f64],
    pub above: f64,
}

/// Vertical bars.
#[derive(Debug, Clone)]
pub(super) struct Bars<'a> {
    /// x, lower and upper y.
    pub limits: &'a [(f64, f64, f64)],
    pub color: usize,
}

/// A quantity over the plane, cell by cell.
#[derive(Debug, Clone)]
pub struct HeatMap<'a> {
    /// Middles of the columns of cells, ascending and evenly spaced (by logarithm on a logarithmic axis).
    pub xs: &'a [f64],
    /// Middles of the rows likewise.
    pub ys: &'a [f64],
    /// One value a cell, row by row from the lowest y; NaN leaves a cell empty.
    pub values: &'a [f64],
    /// What the colours mean.
    pub scale: Scale,
}

/// What the colours of a map mean.
#[derive(Debug, Clone)]
pub enum Scale {
    /// A quantity with this label and unit, from dark (low) to light; if values have both signs, blue below and orange
    /// above a white 0.
    Quantity(String),
    /// Values 0, 1, 2, ... stand for these names, each in a colour of the palette.
    Kinds(Vec<String>),
}

/// A horizontal reference line.
#[derive(Debug, Clone)]
pub(super) struct ReferenceLine {
    pub label: String,
    pub value: f64,
}

/// Points of one quantity. A point that is not finite leaves a gap.
#[derive(Debug, Clone)]
#[must_use]
pub struct Series<'a> {
    pub(super) label: String,
    pub(super) data: Data<'a>,
    pub(super) style: Style,
    /// Index into the palette of Okabe and Ito; `None` is the first colour.
    pub(super) color: Option<usize>,
}

impl<'a> Series<'a> {
    /// A line through `(x, y)` pairs.
    pub fn points(label: impl Into<String>, points: &'a [(f64, f64)]) -> Self {
        Self::new(label, Data::Points(points))
    }

    /// A line through two columns, which must be equally long.
    pub fn columns(label: impl Into<String>, xs: &'a [f64], ys: &'a [f64]) -> Self {
        Self::new(label, Data::Columns { xs, ys })
    }

    /// Sets how the points are drawn.
    pub fn style(self, style: Style) -> Self {
        Self { style, ..self }
    }

    /// Sets the index into the palette, so that one quantity keeps its colour across panels.
    pub fn color(self, index: usize) -> Self {
        Self { color: Some(index), ..self }
    }

    fn new(label: impl Into<String>, data: Data<'a>) -> Self {
        Self { label: label.into(), data, style: Style::Line, color: None }
    }
}

/// Points borrowed from the caller.
#[derive(Debug, Clone, Copy)]
pub(super) enum Data<'a> {
    Points(&'a [(f64, f64)]),
    Columns { xs: &'a [f64], ys: &'a [f64] },
}

impl Data<'_> {
    /// Number of x values and number of y values.
    pub fn lengths(&self) -> (usize, usize) {
        match self {
            Self::Points(points) => (points.len(), points.len()),
            Self::Columns { xs, ys } => (xs.len(), ys.len()),
        }
    }

    /// The points in order; of unequal columns, as far as the shorter one goes.
    pub fn iter(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let (points, xs, ys): (&[(f64, f64)], &[f64], &[f64]) = match self {
            Self::Points(points) => (points, &[], &[]),
            Self::Columns { xs, ys } => (&[], xs, ys),
        };
        points.iter().copied().chain(xs.iter().copied().zip(ys.iter().copied()))
    }
}

/// How the points of a series are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Style {
    /// Straight lines from point to point.
    #[default]
    Line,
    /// A value holds until the next point.
    Steps,
    /// A dot at each point.
    Markers,
    /// A small dot at each point, for clouds of them.
    Dots,
    /// A cross at each point.
    Crosses,
    /// A large dot with a white edge at each point, which stands out from a map.
    Pins,
    /// Straight dashed lines from point to point.
    Dashed,
}

impl Style {
    /// Whether the points stand for themselves, without a line that joins them.
    pub(super) fn is_marks(self) -> bool {
        matches!(self, Self::Markers | Self::Dots | Self::Crosses | Self::Pins)
    }
}
