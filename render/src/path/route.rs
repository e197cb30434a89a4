//! Which way light took from a light to the eye. Every path belongs to one of four routes: those of the three
//! fog effects and, for what met no medium vertex, surfaces alone.

use super::vertex::Vertex;

/// What light met between a light and the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Route {
    /// Surfaces only, or nothing: the medium dimmed it at most.
    #[default]
    Surfaces,
    /// Light, medium, eye.
    Direct,
    /// Light, surface, medium, eye.
    Indirect,
    /// Anything else with the medium in it.
    Multiple,
}

/// The vertices of a path, as far as it was followed from the eye.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Vertices {
    count: u32,
    route: Route,
}

impl Vertices {
    /// How many there are.
    pub const fn count(self) -> u32 {
        self.count
    }

    /// The route of light from a light that the last of them looks at.
    pub const fn route(self) -> Route {
        self.route
    }

    /// With one more, farther from the eye.
    #[must_use]
    pub const fn then(self, vertex: &Vertex) -> Self {
        let route = match (self.count, self.route, vertex) {
            (_, Route::Surfaces, Vertex::Surface { .. }) => Route::Surfaces,
            (0, Route::Surfaces, Vertex::Medium { .. }) => Route::Direct,
            (_, Route::Direct, Vertex::Surface { .. }) => Route::Indirect,
            _ => Route::Multiple,
        };
        Self { count: self.count + 1, route }
    }

    /// Whether this route, or one with more vertices, is the wanted one.
    pub fn lead_to(self, wanted: Route) -> bool {
        self.route == wanted
            || wanted == Route::Multiple
            || (self.route == Route::Direct && wanted == Route::Indirect)
    }
}
