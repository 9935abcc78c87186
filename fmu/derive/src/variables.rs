//! The table of a model.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Data, DeriveInput, Error, Fields, Result};

use crate::field;

/// The associated constant `VARIABLES`, and with it the errors of all fields that make none.
pub(crate) fn expand(input: &DeriveInput) -> TokenStream {
    let name = &input.ident;
    let (rows, error) = match rows(input) {
        Ok(rows) => (rows, None),
        // The table is there all the same, lest its use is another error.
        Err(error) => (Vec::new(), Some(error.into_compile_error())),
    };
    let count = rows.len();
    let (generics, types, bounds) = input.generics.split_for_impl();
    quote! {
        #error

        // Values are within their types: the exporter checks them before.
        #[allow(
            clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_lossless, clippy::unnecessary_cast,
            trivial_numeric_casts
        )]
        impl #generics #name #types #bounds {
            /// The variables in the order of the fields; the value reference of each is its place here.
            pub(crate) const VARIABLES: [::fmu_export::Variable<Self>; #count] = [#(#rows),*];
        }
    }
}

/// A row for each field that has an attribute, in the order of the fields.
fn rows(input: &DeriveInput) -> Result<Vec<TokenStream>> {
    let name = &input.ident;
    let fields = match &input.data {
        Data::Struct(data) => match &data.fields {
            Fields::Named(fields) => &fields.named,
            _ => return Err(Error::new_spanned(name, "a model is a struct whose fields have names")),
        },
        _ => return Err(Error::new_spanned(name, "a model is a struct")),
    };
    if let Some(generic) = input.generics.params.first() {
        return Err(Error::new_spanned(generic, "a model has no generic parameters"));
    }
    let (mut rows, mut errors) = (Vec::new(), None::<Error>);
    for made in fields.iter().map(field::row) {
        match (made, &mut errors) {
            (Ok(row), _) => rows.extend(row),
            (Err(error), Some(errors)) => errors.combine(error),
            (Err(error), none) => *none = Some(error),
        }
    }
    errors.map_or(Ok(rows), Err)
}

#[cfg(test)]
mod tests {
    use syn::parse_quote;

    use super::*;
    use crate::field::NO_TYPE;

    fn refused(input: &DeriveInput) -> String {
        rows(input).unwrap_err().to_string()
    }

    #[test]
    fn what_is_no_model_or_variable_is_refused_with_its_reason() {
        let of = |field: TokenStream| -> String { refused(&parse_quote!(struct Model { #field })) };
        for (field, said) in [
            (quote!(#[input] #[output] x: f64), "a field is one variable"),
            (quote!(#[input] x: [f64; 2]), NO_TYPE),
            (quote!(#[input] x: usize), NO_TYPE),
            (quote!(#[input(unit = "s")] x: i32), "only f64 and f32 have a unit"),
            (quote!(#[input(unit = "s", unit = "m")] x: f64), "unit is given twice"),
            (quote!(#[input(max = 1.0, max = 2.0)] x: f64), "max is given twice"),
            (quote!(#[input(unit = 1)] x: f64), "expected string literal"),
            (quote!(#[input(unit =)] x: f64), "a value is missing"),
            (quote!(#[input = "s"] x: f64), "settings stand in parentheses"),
            (quote!(#[output(start = 1.0)] x: f64), "no output has a start value: the model calculates it"),
            (quote!(#[output_clock] x: f64), "a clock is a bool: whether it ticks"),
            (quote!(#[input(interval = 1.0)] x: bool), "only an input clock has an interval"),
            (quote!(#[calculated_parameter] x: bool), "a calculated parameter is a f64 or f32"),
        ] {
            assert_eq!(of(field.clone()), said, "{field}");
        }
        for (model, said) in [
            ("enum Model {}", "a model is a struct"),
            ("struct Model(f64);", "a model is a struct whose fields have names"),
            ("struct Model<T> { x: T }", "a model has no generic parameters"),
        ] {
            assert_eq!(refused(&syn::parse_str(model).unwrap()), said, "{model}");
        }
    }

    #[test]
    fn what_is_no_choice_is_refused_with_its_reason() {
        for (choice, said) in [
            ("struct Law {}", "a choice is an enum"),
            ("enum Law {}", "a choice has at least one item"),
            ("enum Law { A(f64) }", "an item of a choice has no fields"),
            ("enum Law { A = 3 }", "items are numbered from 1 in their order"),
            ("enum Law<T> { A }", "a choice has no generic parameters"),
        ] {
            let refusal = crate::choice::expand(&syn::parse_str(choice).unwrap()).unwrap_err();
            assert_eq!(refusal.to_string(), said, "{choice}");
        }
    }
}
