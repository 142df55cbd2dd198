//! What is refused, what is deep or coincident, and what must not matter.

use crate::instances::forest;
use crate::shapes::inward;
use crate::worlds::{Random, build, describe, instance, mesh, placed, soup, try_build};
use glam::{DAffine3, DQuat, DVec3};
use understory::geometry::Shape;
use understory::material::Material;
use understory::math::Ray;
use understory::scene::description::{
    Group, GroupId, MaterialId, OrganId, PlacedShape, SceneDescription,
};
use understory::scene::{Problem, Scene, SceneError};

#[test]
fn impossible_groups_are_refused() {
    let build = |groups| Scene::build(describe(groups)).map(|_| ());
    let only = |instances| Group {
        shapes: vec![],
        instances,
    };
    let error = |problem| {
        Err(SceneError::Organ {
            organ: OrganId(42),
            problem,
        })
    };
    let here = DAffine3::IDENTITY;
    assert_eq!(
        build(vec![only(vec![instance(7, here, 42)])]),
        error(Problem::NoGroup(7))
    );
    let cycle = vec![
        only(vec![instance(1, here, 42)]),
        only(vec![instance(0, here, 1)]),
    ];
    assert_eq!(build(cycle), error(Problem::Cycle(1)));
    let flat = DAffine3::from_scale(DVec3::new(1.0, 1.0, 0.0));
    let singular = vec![only(vec![]), only(vec![instance(0, flat, 42)])];
    assert_eq!(build(singular), error(Problem::Singular));
    let no_root = SceneDescription {
        root: Some(GroupId(3)),
        ..SceneDescription::default()
    };
    assert_eq!(
        Scene::build(no_root).map(|_| ()),
        Err(SceneError::NoRoot(3))
    );
    let wrong = PlacedShape {
        material: MaterialId(5),
        ..placed(Shape::Plane, here, 42)
    };
    assert_eq!(
        try_build(vec![wrong]).map(|_| ()),
        error(Problem::NoMaterial(5))
    );
    let bad = vec![Material::default().with_alpha(2.0)];
    let bad = Scene::build(SceneDescription {
        materials: bad,
        ..describe(vec![])
    });
    assert!(matches!(bad, Err(SceneError::Material { index: 0, .. })));
}

/// Each group holds twice the one before it.
fn doubling(levels: u32) -> Vec<Group> {
    let ball = placed(Shape::Sphere { radius: 0.4 }, DAffine3::IDENTITY, 0);
    let shapes = (0..20).map(|k| PlacedShape {
        to_group: DAffine3::from_translation(DVec3::X * f64::from(k)),
        ..ball.clone()
    });
    let mut groups = vec![Group {
        shapes: shapes.collect(),
        instances: vec![],
    }];
    for level in 0..levels {
        let aside = DAffine3::from_translation(DVec3::Y * 2.0_f64.powi(level as i32));
        let instances = vec![
            instance(level, DAffine3::IDENTITY, 1),
            instance(level, aside, 2 + level),
        ];
        groups.push(Group {
            shapes: vec![],
            instances,
        });
    }
    groups
}

/// Each group holds the one before it seventeen times: too many for any to dissolve.
fn widening(levels: u32) -> Vec<Group> {
    let mut groups = doubling(0);
    for level in 0..levels {
        groups.push(Group {
            shapes: vec![],
            instances: (0..17)
                .map(|k| instance(level, DAffine3::IDENTITY, k))
                .collect(),
        });
    }
    groups
}

#[test]
fn deep_nesting_works_up_to_its_limit_and_is_refused_beyond() {
    let scene = Scene::build(describe(doubling(16))).unwrap();
    assert_eq!(scene.stats().world_primitives, 20 << 16);
    for y in [0, 1, 4097, 65_535] {
        let ray = Ray::new(DVec3::new(7.0, f64::from(y), 9.0), DVec3::NEG_Z);
        let hit = scene.closest(&ray).unwrap();
        let point = scene.surface(&ray, &hit);
        assert!((point.position - DVec3::new(7.0, f64::from(y), 0.4)).length() < 1e-9);
        let outermost = if y >= 32_768 { 17 } else { 1 };
        assert_eq!(point.instance_organ, Some(OrganId(outermost)));
    }
    // Where that alone would be too deep, small groups dissolve into one another.
    let scene = Scene::build(describe(doubling(40))).unwrap();
    assert_eq!(scene.stats().world_primitives, 20 << 40);
    let ray = Ray::new(DVec3::new(7.0, (1_u64 << 39) as f64, 9.0), DVec3::NEG_Z);
    let hit = scene.closest(&ray).unwrap();
    assert!((hit.t - 8.6).abs() < 1e-9);
    assert_eq!(scene.surface(&ray, &hit).instance_organ, Some(OrganId(41)));
    let deeper = Scene::build(describe(widening(17))).map(|_| ());
    assert_eq!(deeper, Err(SceneError::TooDeep { limit: 16 }));
    // A chain of groups used once has no depth at all.
    let mut chain = vec![Group {
        shapes: vec![placed(Shape::Sphere { radius: 1.0 }, DAffine3::IDENTITY, 0)],
        instances: vec![],
    }];
    for k in 0..100_000 {
        let step = DAffine3::from_translation(DVec3::X * 1e-3);
        chain.push(Group {
            shapes: vec![],
            instances: vec![instance(k, step, k)],
        });
    }
    let scene = Scene::build(describe(chain)).unwrap();
    let hit = scene
        .closest(&Ray::new(DVec3::X * 200.0, DVec3::NEG_X))
        .unwrap();
    assert!((hit.t - 99.0).abs() < 1e-6);
}

#[test]
fn two_hundred_thousand_things_in_one_place_are_built() {
    let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let same = build(vec![placed(
        mesh(soup(&vec![triangle; 200_000])),
        DAffine3::IDENTITY,
        0,
    )]);
    let plant = Group {
        shapes: (0..20)
            .map(|k| {
                placed(
                    Shape::Sphere {
                        radius: 1.0 + f64::from(k),
                    },
                    DAffine3::IDENTITY,
                    0,
                )
            })
            .collect(),
        instances: vec![],
    };
    let turned = (0..200_000).map(|k| {
        instance(
            0,
            DAffine3::from_quat(DQuat::from_rotation_z(f64::from(k))),
            k,
        )
    });
    let forest = vec![
        plant,
        Group {
            shapes: vec![],
            instances: turned.collect(),
        },
    ];
    let forest = Scene::build(describe(forest)).unwrap();
    let ray = Ray::new(DVec3::new(0.1, 0.1, 50.0), DVec3::NEG_Z);
    assert!(same.closest(&ray).is_some() && forest.closest(&ray).is_some());
    assert!(forest.occluded(&ray));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let groups = forest(&mut Random(55), 3000);
        pool.install(|| Scene::build(describe(groups)).unwrap())
    };
    let (one, four) = (build(1), build(4));
    let mut random = Random(56);
    for _ in 0..3000 {
        let ray = inward(&mut random, 5.0);
        assert_eq!(one.closest(&ray), four.closest(&ray));
    }
}

/// C-65: what an instance may cost.
#[test]
fn an_instance_of_a_forest_costs_little_memory() {
    let mut random = Random(57);
    let mut groups = forest(&mut random, 0);
    let turned = |k: u32| {
        let turn = DAffine3::from_axis_angle(random.direction(), random.between(0.0, 6.0));
        let at = DAffine3::from_translation(random.in_cube() * DVec3::new(1e3, 1e3, 1.0));
        let scale = DAffine3::from_scale(DVec3::splat(random.between(-1.5, -0.5)));
        instance(1, at * turn * scale, k)
    };
    groups[3].instances = (0..20_000).map(turned).collect();
    let stats = Scene::build(describe(groups)).unwrap().stats();
    let each = stats.instance_bytes / stats.instances;
    assert!(each <= 125 && stats.instances == 20_000, "{each}");
}
