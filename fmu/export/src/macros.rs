//! The macro that gives a slave its exported C symbols.

/// Exports a [`Slave`](crate::Slave) as an FMU: defines every C function of FMI 2.0 for co-simulation and, with
/// `export_fmu!(MySlave, model_exchange)`, those for model exchange. Use it once in a `cdylib`. The functions exist as C
/// symbols only; the macro leaves no Rust names behind.
#[macro_export]
macro_rules! export_fmu {
    ($slave:ty $(, $model_exchange:ident)?) => {
        const _: () = {
            use $crate::abi::*;

            $crate::abi::functions!([$crate::__export_fmu] $slave $(, $model_exchange)?);
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
        static FMU: $crate::ffi::Fmu = $crate::ffi::Fmu::new();

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
