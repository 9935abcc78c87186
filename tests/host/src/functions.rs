//! The C functions of an FMU, of a shared library or linked into this program.

use fmu_export::abi;
use libloading::Library;

macro_rules! functions {
    (; create { $($create:tt)* } other { $($other:tt)* } common { $($common:tt)* } exchange { $($exchange:tt)* }) => {
        functions! { $($create)* $($other)* $($common)* @ $($exchange)* }
    };
    ($($name:ident $signature:ident $arguments:tt $(-> $ret:ty)?;)* @
     $($exchange:ident $exchange_signature:ident $exchange_arguments:tt;)*) => {
        /// The functions of both interfaces.
        #[derive(Clone, Copy)]
        #[allow(non_snake_case, missing_docs)] // names of the standard
        pub struct Functions {
            $(pub $name: abi::$signature,)*
            /// Those of model exchange, if the FMU has them.
            pub exchange: Option<Exchange>,
        }

        /// The functions of model exchange.
        #[derive(Clone, Copy)]
        #[allow(non_snake_case, missing_docs)]
        pub struct Exchange {
            $(pub $exchange: abi::$exchange_signature,)*
        }

        impl Functions {
            /// Names of all functions but those of model exchange.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($name),)*];

            /// The functions of a library.
            ///
            /// # Errors
            /// If one is missing; those of model exchange may be missing together.
            ///
            /// # Safety
            /// They must have the signatures of FMI 2.0, and are to be called only as long as the library is loaded.
            pub unsafe fn load(library: &Library) -> Result<Self, libloading::Error> {
                // SAFETY: the caller vouches for the signatures.
                let exchange = unsafe { library.get::<abi::fmi2SetTimeTYPE>("fmi2SetTime") }.is_ok();
                let exchange = exchange.then(|| Ok::<_, libloading::Error>(Exchange {
                    // SAFETY: as above.
                    $($exchange: *unsafe { library.get::<abi::$exchange_signature>(stringify!($exchange)) }?,)*
                }));
                Ok(Self {
                    // SAFETY: as above.
                    $($name: *unsafe { library.get::<abi::$signature>(stringify!($name)) }?,)*
                    exchange: exchange.transpose()?,
                })
            }
        }
    };
}
abi::functions!([functions]);

/// Declares the functions of the FMU that is linked into this program.
#[macro_export]
macro_rules! linked_names {
    () => {
        #[allow(unused_imports)] // where the types are in scope
        use $crate::abi::*;

        $crate::abi::functions!([$crate::__linked] names);
    };
}

/// The functions of the FMU that is linked into this program; `linked_functions!(model_exchange)` if it has those.
#[macro_export]
macro_rules! linked_functions {
    ($($model_exchange:ident)?) => {{
        $crate::linked_names!();
        $crate::abi::functions!([$crate::__linked] values $($model_exchange)?)
    }};
}

#[doc(hidden)]
#[macro_export]
macro_rules! __linked {
    (names;
        create { $($create:ident $create_type:ident($($part:ident: $part_type:ty),*) -> $component:ty;)* }
        other { $($other:ident $other_type:ident($($c:ident: $c_type:ty)?) $(-> $ret:ty)?;)* }
        common { $($name:ident $signature:ident($($argument:ident: $kind:ty),*);)* }
        exchange { $($exchange:ident $exchange_type:ident($($place:ident: $place_type:ty),*);)* }
    ) => {
        #[allow(dead_code)]
        unsafe extern "C" {
            $(pub fn $create($($part: $part_type),*) -> $component;)*
            $(pub fn $other($($c: $c_type)?) $(-> $ret)?;)*
            $(pub fn $name(c: fmi2Component $(, $argument: $kind)*) -> fmi2Status;)*
            $(pub fn $exchange(c: fmi2Component $(, $place: $place_type)*) -> fmi2Status;)*
        }
    };
    (values $($model_exchange:ident)?;
        create { $($create:ident $create_type:ident $parts:tt -> $component:ty;)* }
        other { $($other:ident $other_type:ident $others:tt $(-> $ret:ty)?;)* }
        common { $($name:ident $signature:ident $arguments:tt;)* }
        exchange { $($exchange:ident $exchange_type:ident $places:tt;)* }
    ) => {
        $crate::Functions {
            $($create,)* $($other,)* $($name,)*
            exchange: $crate::__linked!(@ [$($model_exchange)?] $($exchange)*),
        }
    };
    (@ [] $($exchange:ident)*) => { None };
    (@ [model_exchange] $($exchange:ident)*) => { Some($crate::Exchange { $($exchange,)* }) };
}
