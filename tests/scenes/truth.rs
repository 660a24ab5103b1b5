//! Integrators of the scenes' truths. They share nothing with the engine.

use super::G;
use urdf2fmu_core::spatial::{Mat3, Vec3, rotation_from_quaternion};

/// The classical Runge–Kutta method in `count` steps to `end`.
pub fn runge_kutta<const N: usize>(
    rates: impl Fn(&[f64; N]) -> [f64; N],
    start: [f64; N],
    end: f64,
    count: u32,
) -> [f64; N] {
    let h = end / f64::from(count);
    let add = |x: &[f64; N], k: &[f64; N], h: f64| -> [f64; N] {
        std::array::from_fn(|i| x[i] + h * k[i])
    };
    let mut x = start;
    for _ in 0..count {
        let k1 = rates(&x);
        let k2 = rates(&add(&x, &k1, 0.5 * h));
        let k3 = rates(&add(&x, &k2, 0.5 * h));
        let k4 = rates(&add(&x, &k3, h));
        let mean = std::array::from_fn(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0);
        x = add(&x, &mean, h);
    }
    x
}

/// The law of stiffness of a pair of shapes.
///
/// 1. The depth of the pair is `δ = (Σ mᵢ dᵢ⁴)^¼` of the depths `dᵢ` of its points. The weights
///    `mᵢ` are ¼ for a corner of a box, ½ for a rim, an end of a capsule, and each rim of a lying
///    cylinder, 1 for a ball; those of a whole face have the sum 1.
/// 2. The force along `δ` is `K δ (1 + (δ/δ₁)³)` with `δ₁` the stated penetration, and
///    `∂δ/∂dᵢ` of it belongs to each point. Points of equal depth `d` and weights of the sum `m`
///    have `δ = S d` with `S = m^¼`, and press with `S` times the force along `δ`.
/// 3. A whole face carries the weight `W` of its tree at half of the penetration:
///    `K (penetration/2) (1 + 1/8) = W`.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    stiffness: f64,
    deep: f64,
}

impl Law {
    /// - `weight`: N, of the tree
    /// - `penetration`: m, as stated
    pub fn new(weight: f64, penetration: f64) -> Self {
        Self {
            stiffness: weight / (0.5 * penetration * (1.0 + 1.0 / 8.0)),
            deep: penetration,
        }
    }

    /// Force of points with equal depth `d` and weights of the sum `share`.
    pub fn force(&self, d: f64, share: f64) -> f64 {
        let scale = share.sqrt().sqrt();
        let depth = scale * d.max(0.0);
        let stiffer = depth / self.deep;
        scale * self.stiffness * depth * (1.0 + stiffer * stiffer * stiffer)
    }

    /// How deep such points are under `load`: bisection, since the force grows with the depth.
    pub fn depth(&self, load: f64, share: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..200 {
            let d = 0.5 * (low + high);
            if self.force(d, share) < load {
                low = d;
            } else {
                high = d;
            }
        }
        0.5 * (low + high)
    }
}

/// Rates of a free rigid body with the principal moments `I`: unit quaternion (w, x, y, z) and
/// angular velocity in its own axes; Euler's equations.
pub fn euler(I: [f64; 3]) -> impl Fn(&[f64; 7]) -> [f64; 7] {
    move |&[w, x, y, z, p, q, r]| {
        [
            -0.5 * (x * p + y * q + z * r),
            0.5 * (w * p + y * r - z * q),
            0.5 * (w * q + z * p - x * r),
            0.5 * (w * r + x * q - y * p),
            (I[1] - I[2]) / I[0] * q * r,
            (I[2] - I[0]) / I[1] * r * p,
            (I[0] - I[1]) / I[2] * p * q,
        ]
    }
}

/// Rates of a rigid body of 1 kg that turns about a fixed point, with the inertia `I` about that
/// point and its centre of mass at `centre` from it, both in its own axes: unit quaternion and
/// angular velocity in its own axes.
pub fn heavy(I: Mat3, centre: Vec3) -> impl Fn(&[f64; 7]) -> [f64; 7] {
    let inverse = I.try_inverse().expect("inertia");
    let turning = euler([1.0; 3]);
    move |x| {
        let w = vector(&x[4..]);
        let down = rotation_from_quaternion(&[x[0], x[1], x[2], x[3]]).transpose() * Vec3::z() * -G;
        let change = inverse * (centre.cross(&down) - w.cross(&(I * w)));
        let mut rates = turning(x);
        rates[4..].copy_from_slice(change.as_slice());
        rates
    }
}

/// Angle between two orientations given as quaternions, rad.
pub fn angle_between(a: &[f64], b: &[f64]) -> f64 {
    let norm = |q: &[f64]| q.iter().map(|x| x * x).sum::<f64>().sqrt();
    let scalar: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    // |a − b| is twice the sine of a quarter of the turn; −b is the same orientation as b.
    let sign = if scalar < 0.0 { -1.0 } else { 1.0 };
    let (na, nb) = (norm(a), norm(b));
    let apart = a.iter().zip(b).map(|(a, b)| a / na - sign * b / nb);
    let chord = apart.map(|x| x * x).sum::<f64>().sqrt();
    4.0 * libm::asin((0.5 * chord).min(1.0))
}

/// A body of revolution that rolls without slip on a sharp circular edge.
///
/// 1. `k` is the axis from the edge's circle towards the centre of mass, which lies `h` above the
///    circle's centre; `e` is the unit vector across `k` that points down most steeply:
///    `e = −(z − (z·k) k)/|…|`. The contact lies at `r = −h k + R e` from the centre of mass.
/// 2. No slip: the centre of mass has the velocity `v = r × ω`.
/// 3. Its acceleration needs the force `m (v̇ + g z)`, whose moment about the centre of mass turns
///    the body: `I ω̇ + ω × I ω = r × m (ṙ × ω + r × ω̇ + g z)`, a linear equation for `ω̇`.
/// 4. `ṙ` follows from `k̇ = ω × k`.
#[derive(Clone, Copy, Debug)]
pub struct Rolling {
    pub mass: f64,
    /// Of the edge, m.
    pub radius: f64,
    /// Of the centre of mass over the edge's plane, m.
    pub height: f64,
    /// Moments of inertia across and along the axis, kg·m².
    pub across: f64,
    pub along: f64,
}

/// Axis, angular velocity and centre of mass, world axes.
pub type Rolls = [f64; 9];

fn vector(x: &[f64]) -> Vec3 {
    Vec3::new(x[0], x[1], x[2])
}

impl Rolling {
    /// A homogeneous cylinder of half the length `height`.
    pub fn cylinder(mass: f64, radius: f64, height: f64) -> Self {
        Self {
            mass,
            radius,
            height,
            across: mass * (radius * radius / 4.0 + height * height / 3.0),
            along: mass * radius * radius / 2.0,
        }
    }

    /// The contact as seen from the centre of mass.
    pub fn arm(&self, k: &Vec3) -> Vec3 {
        let up = Vec3::z() - k * k.z;
        -k * self.height - up * (self.radius / up.norm())
    }

    /// Angular acceleration.
    pub fn turning(&self, k: &Vec3, w: &Vec3) -> Vec3 {
        let I = Mat3::identity() * self.across + k * k.transpose() * (self.along - self.across);
        let r = self.arm(k);
        let k_rate = w.cross(k);
        let up = Vec3::z() - k * k.z;
        let up_rate = -k * k_rate.z - k_rate * k.z;
        let s = up.norm();
        let e_rate = -up_rate / s + up * (up.dot(&up_rate) / (s * s * s));
        let r_rate = -k_rate * self.height + e_rate * self.radius;
        let R = r.cross_matrix();
        let forced = r.cross(&(r_rate.cross(w) + Vec3::z() * G)) * self.mass - w.cross(&(I * w));
        let left = I - R * R * self.mass;
        left.try_inverse().expect("inertia") * forced
    }

    fn rates(&self, x: &Rolls) -> Rolls {
        let (k, w) = (vector(&x[..3]), vector(&x[3..6]));
        let (k_rate, w_rate, v) = (w.cross(&k), self.turning(&k, &w), self.arm(&k).cross(&w));
        let mut rates = [0.0; 9];
        rates[..3].copy_from_slice(k_rate.as_slice());
        rates[3..6].copy_from_slice(w_rate.as_slice());
        rates[6..].copy_from_slice(v.as_slice());
        rates
    }

    /// Where it is after `time` s.
    pub fn after(&self, start: Rolls, time: f64) -> Rolls {
        let count = (time / 1e-4).ceil() as u32;
        runge_kutta(|x| self.rates(x), start, time, count)
    }

    /// The state with this axis and angular velocity and its centre of mass over the origin.
    pub fn start(&self, k: &Vec3, w: &Vec3) -> Rolls {
        let mut x = [0.0; 9];
        x[..3].copy_from_slice(k.as_slice());
        x[3..6].copy_from_slice(w.as_slice());
        x[8] = -self.arm(k).z;
        x
    }

    /// Rate of turning about the vertical at which a body with axis `k` that spins by `spin`
    /// relative to that turning keeps its lean: the root of the smallest size of
    /// `(ω̇ − Ω z × ω)·y = 0`; `k` lies in the plane of x and z.
    pub fn steady(&self, k: &Vec3, spin: f64) -> f64 {
        let rest = |rate: f64| {
            let w = Vec3::z() * rate + k * spin;
            (self.turning(k, &w) - Vec3::z().cross(&w) * rate).y
        };
        let grid = 0.01;
        let root = (0..100_000).find_map(|i| {
            [1.0, -1.0].into_iter().find_map(|sign| {
                let (a, b) = (sign * grid * f64::from(i), sign * grid * f64::from(i + 1));
                (rest(a) * rest(b) <= 0.0).then_some((a, b))
            })
        });
        let (mut a, mut b) = root.expect("a steady motion");
        for _ in 0..60 {
            let middle = 0.5 * (a + b);
            if rest(a) * rest(middle) <= 0.0 {
                b = middle;
            } else {
                a = middle;
            }
        }
        0.5 * (a + b)
    }
}
