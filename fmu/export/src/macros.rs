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

            $crate::abi::functions!([$crate::__export_fmu] $slave $(, $model_exchange)?);
            $crate::abi::functions3!([$crate::__export_fmu3] $slave);
            $crate::__export_description!($slave);
        };
    };
}

/// Defines the functions of [`abi::functions`](crate::abi::functions) for a slave.
#[doc(hidden)]
#[macro_export]
macro_rules! __export_fmu {
    ($slave:ty, model_exchange;
        create { $($create:tt)* } other { $($other:tt)* } common { $($common:tt)* } exchange { $($exchange:tt)* }
    ) => {
        $crate::__export_fmu! {
            $slave; create { $($create)* } other { $($other)* } common { $($common)* $($exchange)* } exchange {}
        }
    };
    ($slave:ty;
        create { $create:ident $create_type:ident($($part:ident: $part_type:ty),*) -> $component:ty; }
        other { $($other:ident $other_type:ident($($c:ident: $c_type:ty)?) $(-> $ret:ty)?;)* }
        common { $($name:ident $signature:ident($($argument:ident: $kind:ty),*);)* }
        exchange { $($exchange:tt)* }
    ) => {
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $create($($part: $part_type),*) -> $component {
            // SAFETY: the importer keeps the contract of the C function; so below.
            unsafe { $crate::ffi::$create::<$slave>(&FMU, $($part),*) }
        }
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $other($($c: $c_type)?) $(-> $ret)? {
                unsafe { $crate::ffi::$other::<$slave>($($c)?) }
            }
        )*
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name(c: fmi2Component $(, $argument: $kind)*) -> fmi2Status {
                unsafe { $crate::ffi::$name::<$slave>(c $(, $argument)*) }
            }
        )*
    };
}

/// Defines the functions of [`abi::functions3`](crate::abi::functions3) for a slave.
#[doc(hidden)]
#[macro_export]
macro_rules! __export_fmu3 {
    ($slave:ty;
        create { $($create:ident $create_type:ident($($part:ident: $part_type:ty),*) -> $component:ty;)* }
        other { $($other:ident $other_type:ident($($c:ident: $c_type:ty)?) $(-> $ret:ty)?;)* }
        status { $($name:ident $signature:ident($($argument:ident: $kind:ty),*);)* }
    ) => {
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $create($($part: $part_type),*) -> $component {
                // SAFETY: the importer keeps the contract of the C function; so below.
                unsafe { $crate::fmi3::$create::<$slave>(&FMU, $($part),*) }
            }
        )*
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $other($($c: $c_type)?) $(-> $ret)? {
                unsafe { $crate::fmi3::$other::<$slave>($($c)?) }
            }
        )*
        $(
            #[unsafe(no_mangle)]
            unsafe extern "C" fn $name(instance: fmi3Instance $(, $argument: $kind)*) -> fmi3Status {
                unsafe { $crate::fmi3::$name::<$slave>(instance $(, $argument)*) }
            }
        )*
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
