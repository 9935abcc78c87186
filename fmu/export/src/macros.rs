//! The macro that gives a slave its exported C symbols.

/// Exports a [`Slave`](crate::Slave) as an FMU: defines every C function of FMI 3.0, and those of FMI 2.0 for co-simulation and,
/// with `export_fmu!(MySlave, model_exchange)`, for model exchange. One library serves the FMUs of both versions. Use it once in a
/// `cdylib`. The functions exist as C symbols only; the macro leaves no Rust names behind.
#[macro_export]
macro_rules! export_fmu {
    ($slave:ty $(, $model_exchange:ident)?) => {
        const _: () = {
            assert!(cfg!(panic = "unwind"), "with panic = \"abort\" a panic of the model would end the process of the importer");

            use $crate::abi::fmi3::*;
            use $crate::abi::*;

            static FMU: $crate::ffi::Fmu = $crate::ffi::Fmu::new();

            $crate::abi::functions!(
                [$crate::__export_functions] [$($model_exchange)?] $slave, ffi(c: fmi2Component) -> fmi2Status
            );
            $crate::abi::functions3!([$crate::__export_functions] [] $slave, fmi3(instance: fmi3Instance) -> fmi3Status);
            $crate::__export_description!($slave);
        };
    };
}

/// Defines the functions of [`abi::functions`](crate::abi::functions), without those of model exchange unless asked for, or of
/// [`abi::functions3`](crate::abi::functions3) for a slave: the bodies are in a module of this crate.
#[doc(hidden)]
#[macro_export]
macro_rules! __export_functions {
    (@ $slave:ty, $module:ident($instance:ident: $instance_type:ty) -> $status:ty;
        create { $($create:ident $create_type:ident($($part:ident: $part_type:ty),*) -> $component:ty;)* }
        other { $($other:ident $other_type:ident($($c:ident: $c_type:ty)?) $(-> $ret:ty)?;)* }
        $($group:ident { $($name:ident $signature:ident($($argument:ident: $kind:ty),*);)* })*
    ) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $create($($part: $part_type),*) -> $component {
                // SAFETY: the importer keeps the contract of the C function; so below.
                unsafe { $crate::$module::$create::<$slave>(&FMU, $($part),*) }
            }
        )*
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $other($($c: $c_type)?) $(-> $ret)? {
                unsafe { $crate::$module::$other::<$slave>($($c)?) }
            }
        )*
        $($(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name($instance: $instance_type $(, $argument: $kind)*) -> $status {
                unsafe { $crate::$module::$name::<$slave>($instance $(, $argument)*) }
            }
        )*)*
    };
    ([] $slave:ty, $module:ident $instance:tt -> $status:ty;
        create $create:tt other $other:tt common $common:tt exchange $exchange:tt
    ) => {
        $crate::__export_functions! {
            @ $slave, $module $instance -> $status; create $create other $other common $common
        }
    };
    ([$(model_exchange)?] $($functions:tt)*) => {
        $crate::__export_functions! { @ $($functions)* }
    };
}

/// Defines the function that gives the model descriptions to a packager.
#[cfg(feature = "model-description")]
#[doc(hidden)]
#[macro_export]
macro_rules! __export_description {
    ($slave:ty) => {
        #[unsafe(no_mangle)]
        unsafe extern "C" fn fmu_export_describe_1(
            resources: *const ::core::ffi::c_char,
            icon: ::core::ffi::c_int,
            take: $crate::abi::describe::Take,
            context: *mut ::core::ffi::c_void,
        ) {
            // SAFETY: the packager keeps the contract.
            unsafe { $crate::describe::fmu_export_describe_1::<$slave>(resources, icon, take, context) }
        }
    };
}

/// Nothing, in the library of an FMU.
#[cfg(not(feature = "model-description"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __export_description {
    ($slave:ty) => {};
}
