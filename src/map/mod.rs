//! Design maps: a quantity, such as the net power, over two variables of harvester and circuit, with its best point and the limits of the film.
//!
//! The grid is a [`Sweep`](crate::sweep::Sweep): it resumes, and its shards give the same bytes. From the tops of the grid a local search goes
//! on with runs that have the same noise, once over all points and once over those at which no limit of the film is exceeded.

mod axis;
mod best;
mod columns;
mod error;
mod picture;
mod plan;
mod results;
mod search;
mod work;

pub use axis::Axis;
pub use best::{ClosedForms, Point};
pub use columns::Cell;
pub use error::MapError;
pub use picture::{Layers, picture, scaled_unit};
pub use plan::{Plan, Request};
pub use work::{Map, Outcome, run};
