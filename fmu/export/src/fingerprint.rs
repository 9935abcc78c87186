//! The GUID of an FMU, as a hash of its interface.

use crate::fnv::fnv128;
use crate::guid::Guid;
use crate::slave::Slave;
use crate::variable::{Kind, Variable};

impl Guid {
    /// The GUID of an FMU.
    pub fn of<S: Slave>() -> Self {
        let mut fields = Fields(Vec::new());
        let info = S::INFO;
        fields.text("fmi 2.0 co-simulation");
        fields.text(info.model_identifier);
        fields.text(info.version);
        fields.bool(info.can_serialize);
        fields.bool(info.directional_derivatives);
        fields.option(info.model_exchange, Fields::count);
        fields.bool(info.variable_step_size);
        for variable in S::variables() {
            fields.variable(variable);
        }
        // A UUID of version 8 (RFC 9562: contents defined by the implementation).
        let version = (fnv128(&fields.0) & !(0xf << 76)) | (8 << 76);
        Self((version & !(0b11 << 62)) | (0b10 << 62))
    }
}

/// The values that are hashed, without ambiguity: each has a length or a fixed size.
struct Fields(Vec<u8>);

impl Fields {
    fn text(&mut self, text: &str) {
        self.count(text.len());
        self.0.extend(text.as_bytes());
    }

    fn count(&mut self, count: usize) {
        self.0.extend((count as u64).to_le_bytes());
    }

    fn bool(&mut self, value: bool) {
        self.0.push(u8::from(value));
    }

    fn f64(&mut self, value: f64) {
        self.0.extend(value.to_bits().to_le_bytes());
    }

    fn i32(&mut self, value: i32) {
        self.0.extend(value.to_le_bytes());
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
                self.option(s.start, Self::i32);
                self.i32(s.min);
                self.i32(s.max);
            }
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
