//! Constructors of table rows. All of them are `const`, so that a table is a readable `static`.
//!
//! A row is declared by what it is (`parameter`, `input`, `output`, ...), refined (`min`, `tunable`, ...) and
//! finished with its accessors: [`access`](Declaration::access) where the environment may write,
//! [`get`](Declaration::get) where it only reads. A row without accessors does not compile, nor does an
//! output that can be written.

use super::kind::{
    BooleanSpec, ClockInterval, ClockSpec, EnumerationSpec, EnumerationType, Getter, IntegerSpec, IntegerWidth, Kind,
    PartialDerivative, RealSpec, Setter, StringSpec,
};
use super::{Causality, Variability, Variable};
use core::marker::PhantomData;

/// Marks a declaration that needs a getter and a setter.
#[derive(Debug, Clone, Copy)]
pub struct Settable;

/// Marks a declaration that needs a getter only.
#[derive(Debug, Clone, Copy)]
pub struct ReadOnly;

/// A row of the table that still lacks its accessors. `T` is the type with its attributes, `A` is [`Settable`]
/// or [`ReadOnly`].
#[must_use = "a declaration becomes a variable through `access` or `get`"]
pub struct Declaration<T: Copy, A> {
    name: &'static str,
    description: &'static str,
    causality: Causality,
    variability: Variability,
    dependencies: Option<&'static [&'static str]>,
    initial_dependencies: Option<&'static [&'static [&'static str]]>,
    derivative_of: Option<&'static str>,
    alias_of: Option<&'static str>,
    clocks: &'static [&'static str],
    reinit: bool,
    spec: T,
    access: PhantomData<fn(A)>,
}

type Real<M, A> = Declaration<RealSpec<M>, A>;
type Integer<M, A> = Declaration<IntegerSpec<M>, A>;
type Boolean<M, A> = Declaration<BooleanSpec<M>, A>;
type Text<M, A> = Declaration<StringSpec<M>, A>;
type Enumeration<M, A> = Declaration<EnumerationSpec<M>, A>;

const fn declare<T: Copy, A>(
    (causality, variability): (Causality, Variability),
    name: &'static str,
    description: &'static str,
    spec: T,
) -> Declaration<T, A> {
    Declaration {
        name,
        description,
        causality,
        variability,
        dependencies: None,
        initial_dependencies: None,
        derivative_of: None,
        alias_of: None,
        clocks: &[],
        reinit: false,
        spec,
        access: PhantomData,
    }
}

// What a constructor stands for. The getters below are placeholders that `access` and `get` replace.
const PARAMETER: (Causality, Variability) = (Causality::Parameter, Variability::Fixed);
const CALCULATED: (Causality, Variability) = (Causality::CalculatedParameter, Variability::Fixed);
const INPUT: (Causality, Variability) = (Causality::Input, Variability::Continuous);
const OUTPUT: (Causality, Variability) = (Causality::Output, Variability::Continuous);
const DISCRETE_INPUT: (Causality, Variability) = (Causality::Input, Variability::Discrete);
const DISCRETE_OUTPUT: (Causality, Variability) = (Causality::Output, Variability::Discrete);

const fn real<M>(unit: &'static str, start: Option<f64>) -> RealSpec<M> {
    RealSpec {
        unit,
        single: false,
        start,
        min: f64::NEG_INFINITY,
        max: f64::INFINITY,
        nominal: None,
        infinity_allowed: false,
        get: Getter::Field(|_| f64::NAN),
        set: None,
        input_derivatives: None,
        output_derivatives: None,
        partial_derivative: None,
    }
}

const fn integer<M>(start: Option<i64>) -> IntegerSpec<M> {
    let (min, max) = IntegerWidth::Int32.bounds();
    IntegerSpec { width: IntegerWidth::Int32, start, min, max, get: Getter::Field(|_| 0), set: None }
}

const fn boolean<M>(start: Option<bool>) -> BooleanSpec<M> {
    BooleanSpec { start, get: Getter::Field(|_| false), set: None }
}

const fn text<M>(start: Option<&'static str>) -> StringSpec<M> {
    StringSpec { start, longest: usize::MAX, get: Getter::Field(|_| String::new()), set: None }
}

const fn enumeration<M>(of: &'static EnumerationType, start: Option<i32>) -> EnumerationSpec<M> {
    EnumerationSpec { of, start, get: Getter::Field(|_| 0), set: None }
}

/// Further constructors of Real variables.
impl<M> Variable<M> {
    /// A Real that follows from the parameters.
    pub const fn calculated_parameter(
        name: &'static str,
        unit: &'static str,
        description: &'static str,
    ) -> Real<M, ReadOnly> {
        declare(CALCULATED, name, description, real(unit, None))
    }

    /// The independent variable, time.
    pub const fn independent(name: &'static str, description: &'static str) -> Real<M, ReadOnly> {
        let kind = (Causality::Independent, Variability::Continuous);
        declare(kind, name, description, real("s", None))
    }
}

macro_rules! constructors {
    ($($row:ident($spec:ident, $in:ident, $out:ident)
        $parameter:ident $parameter_doc:literal $input:ident $input_doc:literal $output:ident $output_doc:literal
        ($($of:ident: $of_type:ty)?) $start:ident: $start_type:ty;)*) => {
        /// Constructors of variables. The `unit` of a Real is `"1"` where there is none. Inputs and outputs are discrete unless
        /// they are Reals.
        impl<M> Variable<M> {$(
            #[doc = $parameter_doc]
            pub const fn $parameter(
                name: &'static str,
                $($of: $of_type,)?
                $start: $start_type,
                description: &'static str,
            ) -> $row<M, Settable> {
                declare(PARAMETER, name, description, $spec($($of,)? Some($start)))
            }

            #[doc = $input_doc]
            pub const fn $input(
                name: &'static str,
                $($of: $of_type,)?
                $start: $start_type,
                description: &'static str,
            ) -> $row<M, Settable> {
                declare($in, name, description, $spec($($of,)? Some($start)))
            }

            #[doc = $output_doc]
            pub const fn $output(
                name: &'static str,
                $($of: $of_type,)?
                description: &'static str,
            ) -> $row<M, ReadOnly> {
                declare($out, name, description, $spec($($of,)? None))
            }
        )*}
    };
}
constructors! {
    Real(real, INPUT, OUTPUT)
        parameter "A fixed Real parameter; [`tunable`](Declaration::tunable) lets it change between steps."
        input "A continuous Real input." output "A continuous Real output, calculated from the start."
        (unit: &'static str) start: f64;
    Integer(integer, DISCRETE_INPUT, DISCRETE_OUTPUT)
        integer_parameter "A fixed Integer parameter." integer_input "An Integer input."
        integer_output "An Integer output." () start: i64;
    Boolean(boolean, DISCRETE_INPUT, DISCRETE_OUTPUT)
        boolean_parameter "A fixed Boolean parameter." boolean_input "A Boolean input."
        boolean_output "A Boolean output." () start: bool;
    Text(text, DISCRETE_INPUT, DISCRETE_OUTPUT)
        string_parameter "A fixed String parameter." string_input "A String input."
        string_output "A String output." () start: &'static str;
    Enumeration(enumeration, DISCRETE_INPUT, DISCRETE_OUTPUT)
        enumeration_parameter "A fixed parameter that chooses an item; `start` is its number, from 1."
        enumeration_input "An input that chooses an item; `start` is its number, from 1."
        enumeration_output "An output that tells an item." (of: &'static EnumerationType) start: i32;
}

/// Constructors of clocks, which FMI 3.0 alone has.
impl<M> Variable<M> {
    /// A clock that the model makes tick at events: [`Slave::do_step_to_event`](crate::Slave::do_step_to_event) or
    /// [`Slave::handle_events`](crate::Slave::handle_events) tell of one, and the getter says whether this clock ticks there.
    pub const fn output_clock(name: &'static str, description: &'static str) -> Declaration<ClockSpec<M>, ReadOnly> {
        let spec = ClockSpec { interval: ClockInterval::Triggered, get: Getter::Field(|_| false), set: None };
        declare(DISCRETE_OUTPUT, name, description, spec)
    }

    /// A clock that the environment makes tick at events. The setter is told so before the inputs of the event are set, and
    /// that it is over after [`Slave::handle_events`](crate::Slave::handle_events).
    pub const fn input_clock(
        name: &'static str,
        interval: ClockInterval,
        description: &'static str,
    ) -> Declaration<ClockSpec<M>, Settable> {
        declare(DISCRETE_INPUT, name, description, ClockSpec { interval, get: Getter::Field(|_| false), set: None })
    }
}

/// Refinements of any variable.
impl<T: Copy, A> Declaration<T, A> {
    /// Says that this discrete variable belongs to these clocks: FMI 3.0 has it at their ticks, FMI 2.0 not at all.
    pub const fn clocked_by(mut self, clocks: &'static [&'static str]) -> Self {
        self.clocks = clocks;
        self
    }

    /// Lets a parameter, or what follows from it, change between steps.
    pub const fn tunable(mut self) -> Self {
        self.variability = Variability::Tunable;
        self
    }

    /// Makes a Real input or output change at events only.
    pub const fn discrete(mut self) -> Self {
        self.variability = Variability::Discrete;
        self
    }

    const fn finish<M>(self, kind: Kind<M>) -> Variable<M> {
        Variable {
            name: self.name,
            description: self.description,
            causality: self.causality,
            variability: self.variability,
            kind,
            dependencies: self.dependencies,
            initial_dependencies: self.initial_dependencies,
            derivative_of: self.derivative_of,
            alias_of: self.alias_of,
            clocks: self.clocks,
            reinit: self.reinit,
        }
    }
}

/// Refinements of a variable that the environment only reads.
impl<T: Copy> Declaration<T, ReadOnly> {
    /// Makes an output local: for display, not for connections.
    pub const fn local(mut self) -> Self {
        self.causality = Causality::Local;
        self
    }

    /// Promises that an output depends, at a communication point, on these variables and no others. An empty
    /// list says that it has no direct feedthrough, so that masters need not look for algebraic loops.
    pub const fn depends_on(mut self, names: &'static [&'static str]) -> Self {
        self.dependencies = Some(names);
        self
    }

    /// Promises that the initial value depends on the inputs and parameters in these groups of names and on no others. It
    /// must be the value of every valid set of parameters: what an option of the model makes depend counts.
    pub const fn initially_depends_on(mut self, groups: &'static [&'static [&'static str]]) -> Self {
        self.initial_dependencies = Some(groups);
        self
    }
}

/// Refinements of a Real.
impl<M, A> Declaration<RealSpec<M>, A> {
    /// Makes it a Float32 in FMI 3.0.
    pub const fn single(mut self) -> Self {
        self.spec.single = true;
        self
    }

    /// Smallest value allowed.
    pub const fn min(mut self, min: f64) -> Self {
        self.spec.min = min;
        self
    }

    /// Largest value allowed.
    pub const fn max(mut self, max: f64) -> Self {
        self.spec.max = max;
        self
    }

    /// Typical magnitude.
    pub const fn nominal(mut self, nominal: f64) -> Self {
        self.spec.nominal = Some(nominal);
        self
    }
}

impl<M> Declaration<RealSpec<M>, Settable> {
    /// Lets a Set give an infinite value, within `min` and `max`.
    pub const fn infinity_allowed(mut self) -> Self {
        self.spec.infinity_allowed = true;
        self
    }

    /// Takes time derivatives of an input up to `max_order`; `set` gets the order, from 1, and the value. The
    /// model keeps them (so that a saved state holds them) and decides how long they stay in force.
    pub const fn input_derivatives(mut self, max_order: u32, set: fn(&mut M, u32, f64)) -> Self {
        self.spec.input_derivatives = Some((max_order, set));
        self
    }
}

impl<M> Declaration<RealSpec<M>, ReadOnly> {
    /// Gives time derivatives of an output up to `max_order`; `get` gets the order, from 1.
    pub const fn output_derivatives(mut self, max_order: u32, get: fn(&M, u32) -> f64) -> Self {
        self.spec.output_derivatives = Some((max_order, get));
        self
    }

    /// Gives partial derivatives; see [`RealSpec::partial_derivative`].
    pub const fn partial_derivative(mut self, get: PartialDerivative<M>) -> Self {
        self.spec.partial_derivative = Some(get);
        self
    }

    /// Says that this is the time derivative of the variable `name`, which is thereby a continuous state.
    pub const fn derivative_of(mut self, name: &'static str) -> Self {
        self.derivative_of = Some(name);
        self
    }

    /// Says that this derivative always has the value of the variable `name`, as the velocity is that of the position: in FMI 3.0
    /// that variable is the derivative, and this one is not there.
    pub const fn alias_of(mut self, name: &'static str) -> Self {
        self.alias_of = Some(name);
        self
    }

    /// Says that [`handle_events`](crate::Slave::handle_events) may change this continuous state. An integrator may take
    /// any other for continuous.
    pub const fn reinit(mut self) -> Self {
        self.reinit = true;
        self
    }
}

/// Refinements of an Integer.
impl<M, A> Declaration<IntegerSpec<M>, A> {
    /// Its type in FMI 3.0, whose bounds it has if it has no others; without, it is an Int32.
    pub const fn width(mut self, width: IntegerWidth) -> Self {
        let (before, bounds) = (self.spec.width.bounds(), width.bounds());
        if self.spec.min == before.0 {
            self.spec.min = bounds.0;
        }
        if self.spec.max == before.1 {
            self.spec.max = bounds.1;
        }
        self.spec.width = width;
        self
    }

    /// Smallest value allowed.
    pub const fn min(mut self, min: i64) -> Self {
        self.spec.min = min;
        self
    }

    /// Largest value allowed.
    pub const fn max(mut self, max: i64) -> Self {
        self.spec.max = max;
        self
    }
}

/// Refinements of a String.
impl<M> Declaration<StringSpec<M>, Settable> {
    /// Most bytes that a Set may give.
    pub const fn longest(mut self, bytes: usize) -> Self {
        self.spec.longest = bytes;
        self
    }
}

macro_rules! finishers {
    ($($spec:ident $kind:ident $value:ty;)*) => {$(
        impl<M> Declaration<$spec<M>, Settable> {
            /// Finishes the row with its accessors.
            pub const fn access(self, get: fn(&M) -> $value, set: fn(&mut M, $value)) -> Variable<M> {
                self.accessed(Getter::Field(get), Setter::Field(set))
            }

            /// The same by a number: for a table that is known at run time only.
            pub const fn access_element(
                self,
                number: usize,
                get: fn(&M, usize) -> $value,
                set: fn(&mut M, usize, $value),
            ) -> Variable<M> {
                self.accessed(Getter::Element(get, number), Setter::Element(set, number))
            }

            const fn accessed(mut self, get: Getter<M, $value>, set: Setter<M, $value>) -> Variable<M> {
                self.spec.get = get;
                self.spec.set = Some(set);
                let kind = Kind::$kind(self.spec);
                self.finish(kind)
            }
        }

        impl<M> Declaration<$spec<M>, ReadOnly> {
            /// Finishes the row with its getter.
            pub const fn get(self, get: fn(&M) -> $value) -> Variable<M> {
                self.read(Getter::Field(get))
            }

            /// The same by a number: for a table that is known at run time only.
            pub const fn get_element(self, number: usize, get: fn(&M, usize) -> $value) -> Variable<M> {
                self.read(Getter::Element(get, number))
            }

            const fn read(mut self, get: Getter<M, $value>) -> Variable<M> {
                self.spec.get = get;
                let kind = Kind::$kind(self.spec);
                self.finish(kind)
            }
        }
    )*};
}
finishers! {
    RealSpec Real f64;
    IntegerSpec Integer i64;
    BooleanSpec Boolean bool;
    StringSpec String String;
    EnumerationSpec Enumeration i32;
    ClockSpec Clock bool;
}
