//! The derive macros of `fmu-export`, whose documentation describes them.
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a panic is how a test fails"))]

mod choice;
mod field;
mod variables;

use proc_macro::TokenStream;
use syn::{DeriveInput, Lit, Meta, parse_macro_input};

/// Gives a model the table of its variables, from its fields.
#[proc_macro_derive(
    Variables,
    attributes(parameter, calculated_parameter, input, output, local, input_clock, output_clock)
)]
pub fn variables(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    variables::expand(&input).unwrap_or_else(syn::Error::into_compile_error).into()
}

/// Makes an enumeration a choice among items, which a field can have as its type.
#[proc_macro_derive(Choice)]
pub fn choice(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    choice::expand(&input).unwrap_or_else(syn::Error::into_compile_error).into()
}

/// The documentation of an item: its lines with blanks in between, without the full stop.
fn documentation(attributes: &[syn::Attribute]) -> String {
    let line = |attribute: &syn::Attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            syn::Expr::Lit(literal) => match &literal.lit {
                Lit::Str(text) => Some(text.value().trim().to_owned()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    };
    let lines: Vec<_> = attributes.iter().filter_map(line).take_while(|line| !line.is_empty()).collect();
    let text = lines.join(" ");
    text.strip_suffix('.').unwrap_or(&text).to_owned()
}
