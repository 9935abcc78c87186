//! The items of an enumeration.

use proc_macro2::TokenStream;
use quote::quote;
use syn::ext::IdentExt as _;
use syn::{Data, DeriveInput, Error, Fields, Result};

use crate::documentation;

/// The implementation of `Choice`: items are numbered from 1 in their order, and described by their documentation.
pub(crate) fn expand(input: &DeriveInput) -> Result<TokenStream> {
    let name = &input.ident;
    let Data::Enum(data) = &input.data else {
        return Err(Error::new_spanned(name, "a choice is an enum"));
    };
    if let Some(generic) = input.generics.params.first() {
        return Err(Error::new_spanned(generic, "a choice has no generic parameters"));
    }
    let mut items = Vec::new();
    for variant in &data.variants {
        if !matches!(variant.fields, Fields::Unit) {
            return Err(Error::new_spanned(&variant.fields, "an item of a choice has no fields"));
        }
        if let Some((_, number)) = &variant.discriminant {
            return Err(Error::new_spanned(number, "items are numbered from 1 in their order"));
        }
        items.push((&variant.ident, variant.ident.unraw().to_string(), documentation(&variant.attrs)));
    }
    if items.is_empty() {
        return Err(Error::new_spanned(name, "a choice has at least one item"));
    }
    let table = items.iter().map(|(_, item, text)| quote!((#item, #text)));
    let variants: Vec<_> = items.iter().map(|(variant, ..)| variant).collect();
    let numbers: Vec<_> = (1_i32..).take(variants.len()).collect();
    let (type_name, text) = (name.unraw().to_string(), documentation(&input.attrs));
    Ok(quote! {
        impl ::fmu_export::Choice for #name {
            const TYPE: &'static ::fmu_export::EnumerationType = &::fmu_export::EnumerationType {
                name: #type_name,
                description: #text,
                items: &[#(#table),*],
            };

            fn number(&self) -> i32 {
                match self { #(Self::#variants => #numbers),* }
            }

            fn of(number: i32) -> ::core::option::Option<Self> {
                match number {
                    #(#numbers => ::core::option::Option::Some(Self::#variants),)*
                    _ => ::core::option::Option::None,
                }
            }
        }
    })
}
