//! The C functions of FMI 3.0, of a shared library or linked into this program.

use fmu_export::abi;
use fmu_export::abi::fmi3::*;
use libloading::Library;

macro_rules! functions {
    (; create { $($create:tt)* } other { $($other:tt)* } status { $($status:tt)* }) => {
        functions! { $($create)* $($other)* $($status)* }
    };
    ($($name:ident $signature:ident $arguments:tt $(-> $ret:ty)?;)*) => {
        /// All functions.
        #[derive(Clone, Copy)]
        #[allow(non_snake_case, missing_docs)] // names of the standard
        pub struct Functions {
            $(pub $name: $signature,)*
        }

        impl Functions {
            /// The functions of a library.
            ///
            /// # Errors
            /// If one is missing.
            ///
            /// # Safety
            /// They must have the signatures of FMI 3.0, and are to be called only as long as the library is loaded.
            pub unsafe fn load(library: &Library) -> Result<Self, libloading::Error> {
                // SAFETY: the caller vouches for the signatures.
                Ok(Self { $($name: *unsafe { library.get::<$signature>(stringify!($name)) }?,)* })
            }
        }
    };
}
abi::functions3!([functions]);

/// Declares the functions of FMI 3.0 of the FMU that is linked into this program.
#[macro_export]
macro_rules! linked_names3 {
    () => {
        $crate::abi::functions3!([$crate::__linked3] names);
    };
}

/// The functions that `linked_names3!` has declared.
#[macro_export]
macro_rules! linked_functions3 {
    () => {
        $crate::abi::functions3!([$crate::__linked3] values)
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! __linked3 {
    (names;
        create { $($create:ident $create_type:ident($($part:ident: $part_type:ty),*) -> $component:ty;)* }
        other { $($other:ident $other_type:ident($($c:ident: $c_type:ty)?) $(-> $ret:ty)?;)* }
        status { $($name:ident $signature:ident($($argument:ident: $kind:ty),*);)* }
    ) => {
        #[allow(dead_code, missing_docs)]
        unsafe extern "C" {
            $(pub fn $create($($part: $part_type),*) -> $component;)*
            $(pub fn $other($($c: $c_type)?) $(-> $ret)?;)*
            $(pub fn $name(instance: fmi3Instance $(, $argument: $kind)*) -> fmi3Status;)*
        }
    };
    (values;
        create { $($create:ident $create_type:ident $parts:tt -> $component:ty;)* }
        other { $($other:ident $other_type:ident $others:tt $(-> $ret:ty)?;)* }
        status { $($name:ident $signature:ident $arguments:tt;)* }
    ) => {
        $crate::fmi3::Functions { $($create,)* $($other,)* $($name,)* }
    };
}
