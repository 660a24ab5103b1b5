use super::{Kind, Motion, Mount};
use crate::spatial::{Pose, Vec3};
use crate::testing::Random;

const KINDS: [Kind; 5] = [
    Kind::Welded,
    Kind::Free,
    Kind::Turn,
    Kind::Slide,
    Kind::Ball,
];

/// Positions some way from zero, with unit quaternions.
fn somewhere(kind: Kind, random: &mut Random) -> Vec<f64> {
    let mut q: Vec<f64> = (0..kind.nq()).map(|_| random.uniform(-1.0, 1.0)).collect();
    kind.normalize(&mut q);
    q
}

#[test]
fn difference_is_the_inverse_of_advance() {
    let mut random = Random(2);
    for kind in KINDS {
        let q = somewhere(kind, &mut random);
        let v: Vec<f64> = (0..kind.nv()).map(|_| random.uniform(-1.0, 1.0)).collect();
        let (mut moved, mut back) = (q.clone(), v.clone());
        kind.advance(&q, &v, 1.0, &mut moved);
        kind.difference(&moved, &q, &mut back);
        for (v, back) in v.iter().zip(&back) {
            assert!((v - back).abs() < 1e-14, "{kind:?}: {v} {back}");
        }
    }
}

#[test]
fn position_rates_are_those_of_advance() {
    let mut random = Random(3);
    let h = 1e-6;
    for kind in KINDS {
        let q = somewhere(kind, &mut random);
        let v: Vec<f64> = (0..kind.nv()).map(|_| random.uniform(-1.0, 1.0)).collect();
        let (mut ahead, mut behind, mut rate) = (q.clone(), q.clone(), q.clone());
        kind.advance(&q, &v, h, &mut ahead);
        kind.advance(&q, &v, -h, &mut behind);
        kind.position_rates(&q, &v, &mut rate);
        for i in 0..kind.nq() {
            let difference = (ahead[i] - behind[i]) / (2.0 * h);
            assert!((rate[i] - difference).abs() < 1e-9, "{kind:?} {i}");
        }
    }
}

#[test]
fn columns_are_the_rates_of_the_pose() {
    let mut random = Random(4);
    let (base, X) = (
        Pose::from_xyz_rpy(random.vector(1.0), random.vector(1.0)),
        Pose::from_xyz_rpy(random.vector(1.0), random.vector(1.0)),
    );
    let parent = Pose::from_xyz_rpy(random.vector(1.0), random.vector(1.0));
    let mount = Mount {
        base: &base,
        parent: &parent,
        X: &X,
        ratio: 1.0,
        offset: 0.3,
    };
    let h = 1e-6;
    for kind in KINDS {
        let q = somewhere(kind, &mut random);
        let mut S = vec![[0.0; 6]; kind.nv()];
        let mut origin = Vec3::zeros();
        kind.place(&mount, &q, &mut S, &mut origin);
        for (column, S) in S.iter().enumerate() {
            // Where the body's point (0.4, 0.5, 0.6) is in the world after moving for `t` seconds.
            let at = |t: f64| {
                let mut v = vec![0.0; kind.nv()];
                v[column] = 1.0;
                let (mut moved, mut origin) = (q.clone(), Vec3::zeros());
                kind.advance(&q, &v, t, &mut moved);
                let mut S = vec![[0.0; 6]; kind.nv()];
                let pose = kind.place(&mount, &moved, &mut S, &mut origin);
                (pose.point(&Vec3::new(0.4, 0.5, 0.6)), origin)
            };
            let ((x, _), (ahead, o), (behind, p)) = (at(0.0), at(h), at(-h));
            let measured = (ahead - behind + o - p) / (2.0 * h);
            let (omega, linear) = (Vec3::new(S[0], S[1], S[2]), Vec3::new(S[3], S[4], S[5]));
            let stated = linear + omega.cross(&x);
            assert!((measured - stated).norm() < 1e-8, "{kind:?} {column}");
        }
    }
}

#[test]
fn position_errors_are_small_differences() {
    let mut random = Random(5);
    for kind in [Kind::Turn, Kind::Slide] {
        let (q, changed) = ([0.2], [0.2 + 1e-6]);
        let (mut stated, mut measured) = ([0.0], [0.0]);
        kind.position_error(|i| changed[i] - q[i], &mut stated);
        kind.difference(&changed, &q, &mut measured);
        assert!((stated[0] - measured[0]).abs() < 1e-15, "{kind:?}");
    }
    // Quaternions near the identity, where the vector part is half the angle.
    for kind in [Kind::Free, Kind::Ball] {
        let mut q = vec![0.0; kind.nq()];
        kind.identity(&mut q);
        let v: Vec<f64> = (0..kind.nv()).map(|_| random.uniform(-1.0, 1.0)).collect();
        let (mut changed, mut stated) = (q.clone(), v.clone());
        kind.advance(&q, &v, 1e-6, &mut changed);
        kind.position_error(|i| changed[i] - q[i], &mut stated);
        for (v, stated) in v.iter().zip(&stated) {
            assert!((1e-6 * v - stated).abs() < 1e-11, "{kind:?}");
        }
    }
}

#[test]
fn only_bases_hang_in_the_world_and_only_welds_stand_still() {
    for kind in KINDS {
        assert_eq!(kind.is_base(), [Kind::Welded, Kind::Free].contains(&kind));
        assert_eq!(kind.moves(), kind != Kind::Welded);
        assert_eq!(kind.is_free(), kind == Kind::Free);
        assert_eq!(kind.turns_about_its_axis(), kind == Kind::Turn);
    }
    assert_eq!(Motion::Revolute(Vec3::x()).kind(), Kind::Turn);
    assert_eq!(Motion::Prismatic(Vec3::x()).kind(), Kind::Slide);
}
