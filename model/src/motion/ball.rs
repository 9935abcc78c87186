//! What the ball does.

use super::side::Side;
use crate::contact::Contact;

/// Position, m, and velocity, m/s, at a time.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Start {
    /// s.
    pub time: f64,
    /// m.
    pub position: f64,
    /// m/s.
    pub velocity: f64,
}

/// What the ball does.
#[derive(Debug, PartialEq)]
pub enum Ball {
    /// Gravity and friction alone act on it.
    Free,
    /// Friction holds it on the cylinder, between the membranes.
    Stuck,
    /// The membrane carries it.
    Resting(Side),
    /// It presses a membrane in, under the compliant law.
    InContact(Contact),
}

impl Ball {
    /// The present contact under the compliant law.
    pub fn contact(&self) -> Option<&Contact> {
        match self {
            Self::InContact(contact) => Some(contact),
            Self::Free | Self::Stuck | Self::Resting(_) => None,
        }
    }

    /// The membrane that carries it.
    pub fn support(&self) -> Option<Side> {
        match self {
            Self::Resting(side) => Some(*side),
            Self::Free | Self::Stuck | Self::InContact(_) => None,
        }
    }

    /// Whether the cylinder carries it.
    pub fn is_carried(&self) -> bool {
        matches!(self, Self::Resting(_) | Self::Stuck)
    }
}

impl Clone for Ball {
    fn clone(&self) -> Self {
        match self {
            Self::Free => Self::Free,
            Self::Stuck => Self::Stuck,
            Self::Resting(side) => Self::Resting(*side),
            Self::InContact(contact) => Self::InContact(contact.clone()),
        }
    }

    /// Takes no memory that is there already.
    fn clone_from(&mut self, source: &Self) {
        match (self, source) {
            (Self::InContact(contact), Self::InContact(other)) => contact.clone_from(other),
            (ball, other) => *ball = other.clone(),
        }
    }
}
