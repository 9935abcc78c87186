//! Facts about an FMU as a whole.

/// Name, authorship, default experiment and capabilities of an FMU. Capabilities that follow from elsewhere (the
/// variable table, the exporter) are not repeated here: `canInterpolateInputs` and `maxOutputDerivativeOrder`
/// from the derivatives in the table, `canGetAndSetFMUstate` always true.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[allow(clippy::struct_excessive_bools)] // each a capability of its own
pub struct ModelInfo {
    /// Stem of the shared library; a C identifier.
    pub model_identifier: &'static str,
    /// Name of the model.
    pub model_name: &'static str,
    /// One line on what it does.
    pub description: &'static str,
    /// Who wrote the model.
    pub author: &'static str,
    /// Version of the model.
    pub version: &'static str,
    /// Copyright notice.
    pub copyright: &'static str,
    /// License, as an SPDX expression.
    pub license: &'static str,
    /// Name and version of the tool that made the FMU.
    pub generation_tool: &'static str,
    /// Experiment to run unless the user asks for another.
    pub default_experiment: Option<DefaultExperiment>,
    /// Whether [`Slave::write_state`](crate::Slave::write_state) and
    /// [`Slave::read_state`](crate::Slave::read_state) are implemented (`canSerializeFMUstate`).
    pub can_serialize: bool,
    /// Whether the table gives partial derivatives (`providesDirectionalDerivative`).
    pub directional_derivatives: bool,
    /// Number of event indicators, if the FMU offers model exchange, too: the functions of [`Slave`](crate::Slave) for it
    /// are implemented and the table names the derivatives of the continuous states.
    pub model_exchange: Option<usize>,
    /// Whether [`Slave::do_step_to_event`](crate::Slave::do_step_to_event) is implemented: in FMI 3.0 the FMU returns early
    /// from steps (`mightReturnEarlyFromDoStep`) and has event mode in co-simulation (`hasEventMode`).
    pub stops_at_events: bool,
    /// What FMI 3.0 connects at a stroke.
    pub terminals: &'static [Terminal],
    /// Whether the step size may differ from step to step (`canHandleVariableCommunicationStepSize`).
    pub variable_step_size: bool,
}

/// Experiment to run unless the user asks for another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DefaultExperiment {
    /// Start time, s.
    pub start_time: f64,
    /// Stop time, s.
    pub stop_time: f64,
    /// Communication step size, s.
    pub step_size: f64,
    /// Relative tolerance; none if the slave has no use for one.
    pub tolerance: Option<f64>,
}

/// Variables that belong together, for connections in FMI 3.0 (`terminalsAndIcons.xml`): terminals of two FMUs fit if their members
/// have the same names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Terminal {
    /// Name of the terminal.
    pub name: &'static str,
    /// What it is.
    pub description: &'static str,
    /// Name of each member, and the variable that it is.
    pub members: &'static [(&'static str, &'static str)],
}

macro_rules! setters {
    ($($(#[$doc:meta])* $field:ident;)*) => {$(
        $(#[$doc])*
        #[must_use]
        pub const fn $field(mut self, text: &'static str) -> Self {
            self.$field = text;
            self
        }
    )*};
}

impl ModelInfo {
    /// A model whose name is its identifier, all else empty; the step size may vary, states are not serialised.
    pub const fn new(model_identifier: &'static str) -> Self {
        Self {
            model_identifier,
            model_name: model_identifier,
            description: "",
            author: "",
            version: "",
            copyright: "",
            license: "",
            generation_tool: concat!("fmu-export ", env!("CARGO_PKG_VERSION")),
            default_experiment: None,
            can_serialize: false,
            directional_derivatives: false,
            model_exchange: None,
            stops_at_events: false,
            terminals: &[],
            variable_step_size: true,
        }
    }

    setters! {
        /// Sets the name of the model.
        model_name;
        /// Sets the description.
        description;
        /// Sets the author.
        author;
        /// Sets the version.
        version;
        /// Sets the copyright notice.
        copyright;
        /// Sets the license.
        license;
        /// Sets the generation tool.
        generation_tool;
    }

    /// Sets the default experiment: start and stop time and step size, s.
    #[must_use]
    pub const fn default_experiment(mut self, start: f64, stop: f64, step: f64) -> Self {
        self.default_experiment =
            Some(DefaultExperiment { start_time: start, stop_time: stop, step_size: step, tolerance: None });
        self
    }

    /// Sets the relative tolerance of the default experiment; without such an experiment it does nothing.
    #[must_use]
    pub const fn default_tolerance(mut self, tolerance: f64) -> Self {
        if let Some(experiment) = &mut self.default_experiment {
            experiment.tolerance = Some(tolerance);
        }
        self
    }

    /// Says that the state can be serialised.
    #[must_use]
    pub const fn can_serialize(mut self) -> Self {
        self.can_serialize = true;
        self
    }

    /// Says that there are directional derivatives.
    #[must_use]
    pub const fn directional_derivatives(mut self) -> Self {
        self.directional_derivatives = true;
        self
    }

    /// Says that the FMU offers model exchange, with so many event indicators. The symbols of its functions come from
    /// `export_fmu!(MySlave, model_exchange)`.
    #[must_use]
    pub const fn model_exchange(mut self, event_indicators: usize) -> Self {
        self.model_exchange = Some(event_indicators);
        self
    }

    /// Says that steps can stop at events ([`Slave::do_step_to_event`](crate::Slave::do_step_to_event)).
    #[must_use]
    pub const fn stops_at_events(mut self) -> Self {
        self.stops_at_events = true;
        self
    }

    /// Sets the terminals.
    #[must_use]
    pub const fn terminals(mut self, terminals: &'static [Terminal]) -> Self {
        self.terminals = terminals;
        self
    }

    /// Says that all steps must have one size.
    #[must_use]
    pub const fn constant_step_size(mut self) -> Self {
        self.variable_step_size = false;
        self
    }
}
