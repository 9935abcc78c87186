//! The GUID of an FMU, as a hash of its interface.

use crate::fnv::fnv128;
use crate::guid::Guid;
use crate::slave::Slave;
use crate::standard::Standard;
use crate::variable::{ClockInterval, Kind, Variable};

impl Guid {
    /// The GUID of an FMU; in FMI 3.0 it is the instantiation token.
    pub fn of<S: Slave>(standard: Standard) -> Self {
        let mut fields = Fields { bytes: Vec::new(), standard };
        let info = S::INFO;
        fields.text(match standard {
            Standard::Fmi2 => "fmi 2.0 co-simulation",
            Standard::Fmi3 => "fmi 3.0",
        });
        fields.text(info.model_identifier);
        fields.text(info.version);
        fields.bool(info.can_serialize);
        fields.bool(info.directional_derivatives);
        fields.option(info.model_exchange, Fields::count);
        fields.bool(info.variable_step_size);
        for variable in S::variables().iter().filter(|variable| variable.is_of(standard)) {
            fields.variable(variable);
        }
        if standard == Standard::Fmi3 {
            fields.bool(info.stops_at_events);
        }
        // A UUID of version 8 (RFC 9562: contents defined by the implementation).
        let version = (fnv128(&fields.bytes) & !(0xf << 76)) | (8 << 76);
        Self((version & !(0b11 << 62)) | (0b10 << 62))
    }
}

/// The values that are hashed, without ambiguity: each has a length or a fixed size.
struct Fields {
    bytes: Vec<u8>,
    standard: Standard,
}

impl Fields {
    fn text(&mut self, text: &str) {
        self.count(text.len());
        self.bytes.extend(text.as_bytes());
    }

    fn count(&mut self, count: usize) {
        self.bytes.extend((count as u64).to_le_bytes());
    }

    fn bool(&mut self, value: bool) {
        self.bytes.push(u8::from(value));
    }

    fn f64(&mut self, value: f64) {
        self.bytes.extend(value.to_bits().to_le_bytes());
    }

    fn i32(&mut self, value: i32) {
        self.bytes.extend(value.to_le_bytes());
    }

    /// FMI 2.0 has 32 bits, whatever the width.
    fn integer(&mut self, value: i64) {
        let narrow = i32::try_from(value).unwrap_or(if value < 0 { i32::MIN } else { i32::MAX });
        match self.standard {
            Standard::Fmi2 => self.i32(narrow),
            Standard::Fmi3 => self.bytes.extend(value.to_le_bytes()),
        }
    }

    fn option<T>(&mut self, value: Option<T>, write: impl FnOnce(&mut Self, T)) {
        self.bool(value.is_some());
        if let Some(value) = value {
            write(self, value);
        }
    }

    fn variable<M>(&mut self, variable: &Variable<M>) {
        self.text(variable.name());
        self.text(variable.causality().as_str());
        self.text(variable.variability().as_str());
        self.option(variable.derivative_of(), Self::text);
        self.option(variable.dependencies(), |fields, names| {
            fields.count(names.len());
            for name in names {
                fields.text(name);
            }
        });
        if self.standard == Standard::Fmi3 {
            variable.clocks().iter().for_each(|clock| self.text(clock));
            self.option(variable.alias_of(), Self::text);
            self.text(variable.kind().type_name_3());
        }
        // Marks of their own, so that tables without such states and promises keep their GUID.
        if variable.reinit() {
            self.text("reinit");
        }
        if let Some(groups) = variable.initial_dependencies() {
            self.text("initially");
            groups.iter().copied().flatten().for_each(|name| self.text(name));
        }
        self.text(variable.kind().type_name());
        self.kind(variable.kind());
    }

    fn kind<M>(&mut self, kind: &Kind<M>) {
        match kind {
            Kind::Real(s) => {
                self.text(s.unit);
                self.option(s.start, Self::f64);
                self.f64(s.min);
                self.f64(s.max);
                self.option(s.nominal, Self::f64);
                self.bool(s.infinity_allowed);
                self.count(s.input_derivatives.map_or(0, |d| d.0 as usize));
                self.count(s.output_derivatives.map_or(0, |d| d.0 as usize));
            }
            Kind::Integer(s) => {
                self.option(s.start, Self::integer);
                let (min, max) = s.width.bounds(); // no bounds of its own
                self.integer(if s.min == min { i64::MIN } else { s.min });
                self.integer(if s.max == max { i64::MAX } else { s.max });
            }
            Kind::Clock(s) => match s.interval {
                ClockInterval::Triggered => self.bool(false),
                ClockInterval::Periodic { interval, shift } => {
                    self.bool(true);
                    self.f64(interval);
                    self.f64(shift);
                }
            },
            Kind::Boolean(s) => self.option(s.start, Self::bool),
            Kind::String(s) => self.option(s.start, Self::text),
            Kind::Enumeration(s) => {
                self.option(s.start, Self::i32);
                self.text(s.of.name);
                self.count(s.of.items.len());
                s.of.items.iter().for_each(|(name, _)| self.text(name));
            }
        }
    }
}
