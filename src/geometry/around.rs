//! The ball about a shape, and the same shape with its origin in the middle of it.

use super::Shape;
use crate::spatial::Vec3;

impl Shape {
    /// Half way between the least and the largest coordinates, m.
    fn middle(&self) -> Vec3 {
        let Self::Hull { vertices } = self else {
            return Vec3::zeros();
        };
        let first = vertices.first().copied().unwrap_or_else(Vec3::zeros);
        let (low, high) = vertices
            .iter()
            .fold((first, first), |(low, high), v| (low.inf(v), high.sup(v)));
        (low + high) * 0.5
    }

    /// Centre and radius of a ball that holds the shape, m.
    pub fn ball_around(&self) -> (Vec3, f64) {
        let Self::Hull { vertices } = self else {
            return (Vec3::zeros(), self.bounding_radius());
        };
        let center = self.middle();
        let reach = vertices.iter().map(|v| (v - center).norm());
        (center, reach.fold(0.0, f64::max))
    }

    /// The same shape with its origin in the middle, and where that was, m. The corners of a mesh
    /// may be far from its origin, which is often that of the robot, and all that is said of a
    /// shape by its reach from its origin is then of something much larger: which others it may
    /// touch, how far its points turn.
    pub fn centered(&self) -> (Self, Vec3) {
        let Self::Hull { vertices } = self else {
            return (self.clone(), Vec3::zeros());
        };
        let center = self.middle();
        let vertices = vertices.iter().map(|v| v - center).collect();
        (Self::Hull { vertices }, center)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;

    #[test]
    fn a_hull_in_its_middle_is_the_same_and_reaches_no_farther_than_its_ball() {
        let mut random = Random(0x2545_F491_4F6C_DD1D);
        for _ in 0..100 {
            let far = random.vector(10.0);
            let vertices: Vec<Vec3> = (0..12).map(|_| far + random.vector(0.1)).collect();
            let hull = Shape::Hull {
                vertices: vertices.clone(),
            };
            let (own, center) = hull.centered();
            let (middle, radius) = hull.ball_around();
            assert_eq!(center, middle);
            assert!((own.bounding_radius() - radius).abs() <= 1e-14);
            assert!(radius < 0.2, "{radius}");
            let Shape::Hull { vertices: moved } = own else {
                panic!("still a hull");
            };
            for (a, b) in vertices.iter().zip(&moved) {
                assert!((a - center - b).norm() <= 1e-14);
            }
        }
    }
}
