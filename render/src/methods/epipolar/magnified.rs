//! By how much errors of the integrand's decomposition are magnified.
//!
//! The integrand counts ways from the points of the medium's box that are nearest to the eye and to the
//! light. On a view ray that enters it farther away, and of light rays that do, less is left, and the rest is
//! multiplied by what the integrand took away too much: its errors, too, which are shares of its largest
//! value.

use super::super::shafts::{Haze, IntegrationInputs, LampPosition};
use super::integrand::Ways;

/// What decides of the view rays of a lamp.
#[derive(Clone, Copy, Debug)]
pub struct Magnified<'a> {
    /// The lamp.
    pub lit: &'a IntegrationInputs<'a>,
    /// What scatters its light.
    pub haze: &'a Haze<'a>,
    /// What the integrand counts.
    pub ways: Ways,
    /// Metres in the medium after which nothing is seen.
    pub deep: f32,
    /// The optical depth that is not too much.
    pub most: f32,
}

impl Magnified<'_> {
    /// Whether the optical depth, in the colour that is dimmed most, that the integrand counts too much on a
    /// view ray and on the light rays which it crosses is too much.
    pub fn is_too_much(&self, ray: usize) -> bool {
        let [near, far] = self.lit.rays.spans[ray];
        let of_light = || {
            let [first, last] =
                [near, far.min(near + self.deep)].map(|distance| self.of_light(ray, distance));
            first.max(last).max(0.0)
        };
        self.haze.extinction.max_element() * (near - self.ways.view + of_light()) > self.most
    }

    /// Whether it may be on any view ray: none of the two is longer than the medium's box.
    pub fn may_be_too_much(&self) -> bool {
        let extinction = self.haze.extinction.max_element();
        let times = if self.ways.view > 0.0 { 2.0 } else { 1.0 };
        self.haze.bounds().is_some_and(|bounds| times * extinction * bounds.diagonal() > self.most)
    }

    /// How much too far the light ray is counted through a point of a view ray, metres. Between two points it
    /// is hardly more than at both.
    fn of_light(&self, ray: usize, distance: f32) -> f32 {
        let eye = self.lit.rays.eye;
        let point = eye + self.lit.rays.directions[ray] * distance;
        match self.lit.lamp.position {
            LampPosition::Distant(towards) => {
                let entry = (point - eye).dot(towards) + self.haze.way_in(point, towards, f32::INFINITY);
                self.ways.view - self.ways.least - entry
            }
            LampPosition::Local(position) => {
                let reach = position.distance(point);
                let towards = (position - point) / reach.max(f32::MIN_POSITIVE);
                reach - self.haze.way_in(point, towards, reach) - self.ways.light
            }
        }
    }
}
