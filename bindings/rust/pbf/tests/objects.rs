//! Shapes, queries, emitters, phases, loads and batches, against what geometry and mechanics say they
//! must be; the backend is that of PBF_TEST_BACKEND, or "auto".
use pbf::{
    Anisotropy, Batch, Collider, Desc, DiffuseArrays, Emitter, Error, Field, Params, Phase,
    Reservoir, Rows, SampleGrid, Samples, Shape, Solver, Status, Volume,
};
use std::panic::{catch_unwind, AssertUnwindSafe};

const D: f64 = 0.05; // the spacing by default

fn desc(dimension: u32, capacity: u32) -> Desc {
    let backend = std::env::var("PBF_TEST_BACKEND").unwrap_or_else(|_| "auto".into());
    Desc {
        backend,
        dimension,
        capacity,
        threads: 2,
        ..Default::default()
    }
}

/// A lattice of 10 by 10 by 10 particles, at rest, in a corner of the tank.
fn block() -> Solver<f32> {
    let mut fluid = Solver::new(&desc(3, 1000), &Params::default()).unwrap();
    let at = |n: usize| (n as f32 + 0.5) * D as f32;
    let positions: Vec<f32> = (0..1000)
        .flat_map(|i| [at(i % 10), at(i / 10 % 10), at(i / 100)])
        .collect();
    fluid.add_particles(&positions, None).unwrap();
    fluid
}

/// Half extents 0.2, 0.1 and 0.3, by its corners.
fn brick() -> Shape {
    let corners: Vec<f64> = (0..8)
        .flat_map(|i| {
            [
                0.2 * (2 * (i & 1) - 1) as f64,
                0.1 * ((i & 2) - 1) as f64,
                0.3 * ((i & 4) / 2 - 1) as f64,
            ]
        })
        .collect();
    Shape::from_points(3, &corners, 0.025).unwrap()
}

fn near(wanted: f64, got: f64, bound: f64) {
    assert!((wanted - got).abs() <= bound, "{got}, not {wanted}");
}

fn assert_refused<R>(result: Result<R, Error>, status: Status, words: &str) {
    let error = result.err().expect("a refusal");
    assert_eq!(error.status(), status);
    assert!(
        error.to_string().contains(words),
        "\"{error}\" lacks \"{words}\""
    );
}

#[test]
fn shapes_are_as_far_as_their_faces() {
    let brick = brick();
    near(0.2 * 0.1 * 0.3 * 8., brick.info().unwrap().volume, 1e-3);
    let (distance, normal) = brick.distance(&[0.24, 0., 0.]).unwrap();
    near(0.04, distance, 1e-3);
    near(1., normal[0], 1e-3);
    near(-0.04, brick.distance(&[0., 0.06, 0.]).unwrap().0, 1e-3);

    // The same brick as distances, as a mesh of it, and as a terrain.
    let nodes = [33, 17, 49];
    let inside = |x: f64, half: f64| x.abs() - half;
    let mut values = Vec::new();
    for k in 0..nodes[2] {
        for (j, i) in (0..nodes[1] * nodes[0]).map(|n| (n / nodes[0], n % nodes[0])) {
            let at = [i, j, k].map(|n| f64::from(n) * 0.025);
            let q = [
                inside(at[0] - 0.4, 0.2),
                inside(at[1] - 0.2, 0.1),
                inside(at[2] - 0.6, 0.3),
            ];
            let outside = q.iter().map(|q| q.max(0.).powi(2)).sum::<f64>().sqrt();
            values.push((outside + q[0].max(q[1]).max(q[2]).min(0.)) as f32);
        }
    }
    let grid = Shape::from_grid(&nodes, &[-0.4, -0.2, -0.6], 0.025, &values).unwrap();
    near(0.15, grid.distance(&[0.35, 0., 0.]).unwrap().0, 1e-3);
    let square = [0., 0., 1., 0., 1., 1., 0., 1.];
    let mesh = Shape::from_mesh(2, &square, &[0, 1, 1, 2, 2, 3, 3, 0], 0.05).unwrap();
    near(1., mesh.info().unwrap().volume, 5e-3);
    near(0.08, mesh.distance(&[1.08, 0.5]).unwrap().0, 1e-3);
    let shell = Shape::from_shell(2, &square[..4], &[0, 1], 0.05, 0.2).unwrap();
    near(0.08, shell.distance(&[0.5, 0.18]).unwrap().0, 1e-3);
    let hill = Shape::from_heights(&[3], &[0.5, 0.5, 0.5], 0.5, -0.5, 0.05).unwrap();
    near(0.08, hill.distance(&[0.5, 0.58]).unwrap().0, 1e-3);
}

#[test]
fn shapes_come_back_from_bytes() {
    let shape = brick();
    let again = Shape::load(&shape.save().unwrap()).unwrap();
    let info = shape.info().unwrap();
    assert_eq!(again.info().unwrap().hash, info.hash);
    assert_eq!(again.dimension(), 3);
    let values = again.values().unwrap();
    let nodes: usize = info.nodes.iter().map(|&n| n as usize).product();
    assert_eq!(values.len(), nodes);
    let corner = [0.2, 0.1, 0.3];
    let away: f64 = (0..3).map(|k| (info.origin[k] + corner[k]).powi(2)).sum();
    near(away.sqrt(), f64::from(values[0]), 1e-3);
    assert_refused(Shape::load(b"PBFSHAPE"), Status::Data, "cut short");
}

#[test]
fn shapes_live_while_something_has_them() {
    let mut fluid = block();
    let shape = brick();
    let references = |shape: &Shape| shape.info().unwrap().references;
    let solid = Collider::solid(&shape, [0.7, 0.9, 0.7]);
    assert_eq!(references(&shape), 2);
    fluid.set_colliders(std::slice::from_ref(&solid)).unwrap();
    assert_eq!(references(&shape), 3);
    drop((shape, solid)); // the solver's alone
    fluid.step(1).unwrap();
    let back = fluid.colliders().unwrap();
    let shape = back[0].shape().unwrap().clone();
    assert_eq!(references(&shape), 3);
    drop((fluid, back));
    assert_eq!(references(&shape), 1);
    std::thread::spawn(move || shape.info().unwrap())
        .join()
        .unwrap();
}

#[test]
fn what_is_no_shape_is_refused() {
    let wrong = Status::InvalidArgument;
    assert_refused(
        Shape::from_points(3, &[0.; 9], 0.1),
        wrong,
        "point_count is 3",
    );
    assert_refused(Shape::from_points(3, &[0.; 8], 0.1), wrong, "8 numbers");
    assert_refused(Shape::from_points(4, &[0.; 8], 0.1), wrong, "dimension");
    assert_refused(
        Shape::from_grid(&[3, 3], &[0.; 2], 0.1, &[0.; 8]),
        wrong,
        "8 numbers",
    );
    assert_refused(Shape::from_grid(&[3], &[0.], 0.1, &[0.; 3]), wrong, "nodes");
    assert_refused(
        Shape::from_heights(&[2, 2], &[0.; 3], 1., -1., 0.1),
        wrong,
        "3 numbers",
    );
    assert_refused(
        Shape::from_mesh(2, &[0., 0., 1., 0., 1., 1.], &[0, 1, 1, 7], 0.1),
        wrong,
        "faces[1][1] is 7",
    );
    assert_refused(brick().distance(&[0.; 2]), wrong, "2 numbers");
    let mut fluid = Solver::<f32>::new(&desc(2, 1), &Params::default()).unwrap();
    let solid = Collider::solid(&brick(), [0.5; 3]);
    assert_refused(
        fluid.set_colliders(std::slice::from_ref(&solid)),
        wrong,
        "3D",
    );
    let mut forged = Collider::sphere([0.5; 3], 0.1);
    forged.shape = solid.shape;
    forged.geometry = 8 as *mut _;
    assert_refused(fluid.set_colliders(&[forged]), wrong, "no shape that lives");
}

#[test]
fn queries_know_water_at_rest() {
    let fluid = block();
    let (mut rho, mut v, mut p, mut wet) = ([0.; 2], [9.; 6], [9.; 2], [9; 2]);
    let into = Samples {
        densities: Some(&mut rho),
        velocities: Some(&mut v),
        pressures: Some(&mut p),
        wet: Some(&mut wet),
    };
    fluid
        .sample(&[0.25, 0.25, 0.25, 0.9, 0.9, 0.9], into)
        .unwrap();
    near(1., rho[0], 0.01);
    assert_eq!((rho[1], v, wet), (0., [0.; 6], [1, 0]));
    let grid = SampleGrid {
        counts: [1, 1, 3],
        origin: [0.25; 3],
        step: [0., 0., 0.3],
    };
    let mut along = [0.; 3];
    let into = Samples {
        densities: Some(&mut along),
        ..Default::default()
    };
    fluid.sample_on_grid(&grid, into).unwrap();
    near(1., along[0], 0.01);
    assert!(along[1] < 0.5); // above the surface
    assert_eq!(along[2], 0.);

    near(0.5, fluid.levels(&[0.25, 0., 0.25]).unwrap()[0], 0.01);
    assert!(fluid.levels(&[0.9, 0., 0.9]).unwrap()[0].is_nan());
    let (mut distances, mut normals) = ([0.; 2], [0.; 6]);
    let (origins, down) = ([0.25, 0.9, 0.25, 0.9, 0.9, 0.9], [0., -1., 0., 0., -1., 0.]);
    fluid
        .cast_rays(
            &origins,
            &down,
            f64::INFINITY,
            &mut distances,
            Some(&mut normals),
        )
        .unwrap();
    near(0.4, distances[0], 0.01);
    near(1., normals[1], 0.01);
    assert!(distances[1].is_infinite());

    let corner = Volume::cuboid([0.05, 0.05, 0.05], [0.05; 3]);
    assert_eq!(
        fluid.find_in(&corner).unwrap(),
        [0, 1, 10, 11, 100, 101, 110, 111]
    );
    let half = Volume::cuboid([0.25, 0.5, 0.25], [0.1; 3]);
    let flows = fluid
        .measure(&[half, Volume::sphere([0.8; 3], 0.1)])
        .unwrap();
    near(0.008, flows[0].volume, 1e-12);
    near(0.5, flows[0].fraction, 0.05);
    assert_eq!(flows[1].fraction, 0.);
    let pill = Volume::capsule([0.25; 3], [1., 0., 0.], 0.1, 0.05);
    near(1., fluid.measure(&[pill]).unwrap()[0].fraction, 1e-9);
}

#[test]
fn queries_want_arrays_that_fit() {
    let mut fluid = block();
    let wrong = Status::InvalidArgument;
    let (mut few, mut more) = ([0.; 1], [0.; 3]);
    let into = Samples {
        densities: Some(&mut few),
        ..Default::default()
    };
    assert_refused(
        fluid.sample(&[0.; 6], into),
        wrong,
        "densities has 1 elements; it must have 2",
    );
    let into = Samples {
        velocities: Some(&mut more),
        ..Default::default()
    };
    assert_refused(fluid.sample(&[0.; 6], into), wrong, "velocities has 3");
    assert_refused(
        fluid.sample(&[0.; 4], Samples::default()),
        wrong,
        "4 numbers",
    );
    let grid = SampleGrid {
        counts: [u32::MAX; 3],
        origin: [0.; 3],
        step: [0.; 3],
    };
    assert_refused(
        fluid.sample_on_grid(&grid, Samples::default()),
        wrong,
        "counts",
    );
    let grid = SampleGrid {
        counts: [u32::MAX, u32::MAX, 1], // whose numbers no usize holds
        ..grid
    };
    let many = fluid.sample_on_grid(&grid, Samples::default());
    assert_refused(many, wrong, "count");
    assert_refused(
        fluid.cast_rays(&[0.; 3], &[0.; 2], 1., &mut few, None),
        wrong,
        "directions has 2",
    );
    assert_refused(fluid.levels(&[0.; 4]), wrong, "4 numbers");
    fluid.end_queries().unwrap();
}

#[test]
fn as_much_comes_as_the_rate_says() {
    let mut params = Params::default();
    params.time_step = 1. / 128.;
    params.gravity = [0.; 3];
    let mut fluid = Solver::<f32>::new(&desc(3, 1000), &params).unwrap();
    let mut tap = Emitter::disc([0.5, 0.9, 0.5], [0., -1., 0.], 0.15);
    tap.rate = 0.0371;
    let slit = Emitter::rectangle([0.5, 0.7, 0.5], [0., -1., 0.], 0.1, 0.125);
    fluid.set_emitters(&[tap]).unwrap();
    fluid
        .set_drains(&[Volume::cuboid([0.5, 0.1, 0.5], [0.5, 0.1, 0.5])])
        .unwrap();
    fluid.step(256).unwrap();
    let after = fluid.in_out().unwrap();
    near(0.0371 * 2. / D.powi(3), after.emitted as f64, 1.);
    assert!(after.drained > 0);
    assert_eq!(
        (after.emitted - after.drained) as usize,
        fluid.count().unwrap()
    );
    assert_eq!(fluid.emitters().unwrap()[0].radius, 0.15);
    assert_eq!(fluid.drains().unwrap()[0].half_extents, [0.5, 0.1, 0.5]);
    fluid
        .set_reservoirs(&[Reservoir::cuboid([0.5; 3], [0.5; 3], 0.1)])
        .unwrap();
    fluid.step(1).unwrap();
    assert!(fluid.reservoirs().unwrap()[0].added > 0);
    fluid.set_reservoirs(&[]).unwrap();
    fluid.set_emitters(&[tap, slit]).unwrap();
    assert_eq!(fluid.emitters().unwrap()[1].half_height, 0.125);
    tap.rate = 100.;
    assert_refused(
        fluid.set_emitters(&[tap]),
        Status::InvalidArgument,
        "emitters[0].rate is 100",
    );
}

/// Without drag it falls along a parabola.
#[test]
fn spray_flies() {
    let mut fluid = block();
    let (x, v) = ([0.7, 0.9, 0.7, 0.8, 0.9, 0.7], [0.5, 0., 0., 0., 0.25, 0.]);
    assert_refused(
        fluid.add_diffuse(&x, Some(&v), &[1., 2.]),
        Status::State,
        "pbf_set_diffuse",
    );
    assert!(fluid.diffuse().unwrap().is_none());
    let mut wanted = fluid.default_diffuse().unwrap();
    wanted.capacity = 7;
    wanted.struct_size = 0;
    fluid.set_diffuse(Some(&wanted)).unwrap();
    assert_eq!(fluid.diffuse().unwrap().unwrap().capacity, 7);
    fluid.add_diffuse(&x, Some(&v), &[1., 2.]).unwrap();
    fluid.add_diffuse(&[0.8; 3], None, &[0.01]).unwrap();
    fluid.shift_diffuse(&[0., -0.25, 0.]).unwrap();
    fluid.step(8).unwrap();
    let info = fluid.diffuse_info().unwrap();
    assert_eq!((info.count, info.spray, info.expired), (2, 2, 1));

    let (mut at, mut speeds) = ([0f32; 6], [0f32; 6]);
    let (mut ages, mut lives, mut kinds, mut ids) = ([0f32; 2], [0f32; 2], [9; 2], [9; 2]);
    let into = DiffuseArrays {
        positions: Some(&mut at[..]),
        velocities: Some(&mut speeds[..]),
        ages: Some(&mut ages[..]),
        lives: Some(&mut lives[..]),
        kinds: Some(&mut kinds[..]),
        ids: Some(&mut ids[..]),
    };
    fluid.read_diffuse(0, 2, into).unwrap();
    let params = fluid.params().unwrap();
    let time = 8. * params.time_step;
    let fall = params.gravity[1] / 2. * time * time;
    near(0.7 + 0.5 * time, at[0].into(), 1e-6);
    near(0.65 + fall, at[1].into(), 1e-6);
    near(0.65 + 0.25 * time + fall, at[4].into(), 1e-6);
    near(0.25 + params.gravity[1] * time, speeds[4].into(), 1e-6);
    near(2. - time, lives[1].into(), 1e-6);
    near(time, ages[1].into(), 1e-6);
    assert_eq!((kinds, ids), ([pbf::sys::PBF_DIFFUSE_SPRAY; 2], [0, 1]));

    let short = DiffuseArrays {
        lives: Some(&mut lives[..1]),
        ..Default::default()
    };
    let invalid = Status::InvalidArgument;
    assert_refused(
        fluid.read_diffuse(0, 2, short),
        invalid,
        "lives has 1 elements; it must have 2",
    );
    assert_refused(
        fluid.read_diffuse(1, 2, DiffuseArrays::default()),
        Status::NotFound,
        "there are 2 diffuse particles",
    );
    assert_refused(
        fluid.add_diffuse(&x, None, &[1.]),
        invalid,
        "positions has 6 elements; it must have 3",
    );
    assert_refused(fluid.add_diffuse(&x, None, &[1., 0.]), invalid, "lives[1]");
    assert_refused(fluid.shift_diffuse(&[0.]), invalid, "way has 1 numbers");
    wanted.capacity = 0;
    assert_refused(fluid.set_diffuse(Some(&wanted)), invalid, "capacity is 0");
    assert_eq!(fluid.diffuse_info().unwrap().count, 2);
    fluid.set_diffuse(None).unwrap();
    assert_eq!(fluid.diffuse_info().unwrap().capacity, 0);
}

/// Oil that begins below water: it rises, and the floor has the weight of both, beside what the full
/// tank's ceiling pushes back.
#[test]
fn oil_floats_and_the_floor_bears_both() {
    let mut params = Params::default();
    params.domain_max = [0.5, 1., 1.];
    params.loads = 1;
    let mut fluid = Solver::<f64>::new(&desc(2, 200), &params).unwrap();
    let at = |n: usize| (n as f64 + 0.5) * D;
    let positions: Vec<f64> = (0..200).flat_map(|i| [at(i % 10), at(i / 10)]).collect();
    fluid.add_particles(&positions, None).unwrap();
    fluid
        .set_phases(&[Phase::new(1.), Phase::new(0.5)])
        .unwrap();
    fluid.set_particle_phases(0, &[1; 100]).unwrap();
    assert_eq!(fluid.phases().unwrap()[1].rest_density, 0.5);
    fluid.step((10. / params.time_step) as u32).unwrap();
    fluid.wall_loads().unwrap();
    fluid.step((1. / params.time_step) as u32).unwrap();

    let (y, phases) = (fluid.positions().unwrap(), fluid.particle_phases().unwrap());
    let mean = |phase: u32| {
        let of = (0..200).filter(|&i| phases[i] == phase);
        of.map(|i| y[2 * i + 1]).sum::<f64>() / 100.
    };
    assert!(mean(1) > mean(0) + 0.3, "{} and {}", mean(1), mean(0));
    let loads = fluid.wall_loads().unwrap();
    let impulse = |wall: u32| loads[wall as usize].impulse_sum[1];
    let both = impulse(pbf::sys::PBF_WALL_Y_MIN) + impulse(pbf::sys::PBF_WALL_Y_MAX);
    let weight = D * D * (100. + 0.5 * 100.) * params.gravity[1];
    near(1., both / loads[0].time_sum / weight, 0.005);
    assert_refused(
        fluid.set_particle_phases(0, &[2]),
        Status::InvalidArgument,
        "phases[0] is 2",
    );
    assert_refused(
        fluid.set_phases(&[Phase::new(-1.), Phase::new(1.)]),
        Status::InvalidArgument,
        "phases[0].rest_density is -1",
    );
}

#[test]
fn worlds_fall_as_they_would_alone() {
    let params = Params::default();
    let mut batch = Batch::<f64>::new(&desc(3, 10), &params, 3).unwrap();
    assert_eq!((batch.len(), batch.info().unwrap().worlds), (3, 3));
    batch
        .add_particles(&[1, 0, 2], &[0.5; 9], Some(&[0.; 9]))
        .unwrap();
    assert_eq!(batch.counts().unwrap(), [1, 0, 2]);
    batch.set_start(None, None).unwrap();
    let gravity = [[0., -1., 0.], [0., -2., 0.], [3., 0., 0.]];
    batch.set_gravity(None, &gravity).unwrap();
    batch.step(Some(&[true, false, true]), 12).unwrap();
    let mut v = [9.; 3 * 2 * 3];
    batch.read(None, Field::Velocity, &mut v).unwrap();
    let t = 12. * params.time_step;
    near(-t, v[1], 1e-12);
    assert_eq!(v[3..12], [0.; 9]); // rows that worlds have not
    near(3. * t, v[12], 1e-9);

    let mut alone = Solver::<f64>::new(&desc(3, 10), &params).unwrap();
    alone.add_particles(&[0.5; 3], None).unwrap();
    let mut changed = params;
    changed.gravity = gravity[0];
    alone.set_params(&changed).unwrap();
    alone.step(12).unwrap();
    assert_eq!(
        batch.world(0).unwrap().hash().unwrap(),
        alone.hash().unwrap()
    );
    batch.reset(Some(&[true, false, false])).unwrap();
    let world = batch.world(0).unwrap();
    assert_eq!(world.positions().unwrap(), [0.5; 3]);
    assert_eq!(world.params().unwrap().gravity, params.gravity);
    drop(world);

    let ball = Collider::sphere([0.2; 3], 0.1);
    batch.set_colliders(None, &[ball]).unwrap();
    let targets = [[0.2, 0.3, 0.2]; 3];
    batch.move_colliders(None, &targets, None, 0.1).unwrap();
    batch.step(None, 12).unwrap();
    let reached = batch.world(1).unwrap().colliders().unwrap()[0].position[1];
    near(0.3, reached, 1e-9);
}

#[test]
fn a_world_that_fails_says_so() {
    let mut batch = Batch::<f32>::new(&desc(3, 2), &Params::default(), 2).unwrap();
    batch.add_particles(&[0, 1], &[0.5; 3], None).unwrap();
    std::mem::forget(batch.world(1).unwrap().map(Field::Position).unwrap());
    assert_refused(batch.step(None, 1), Status::State, "world 1: ");
    let results = batch.results().unwrap();
    assert!(results[0].is_ok());
    assert_refused(results[1].clone(), Status::State, "map");
    let wrong = Status::InvalidArgument;
    assert_refused(batch.step(Some(&[true]), 1), wrong, "mask has 1");
    assert_refused(
        batch.add_particles(&[1, 1], &[0.5; 3], None),
        wrong,
        "positions has 3",
    );
    assert_refused(batch.set_gravity(None, &[[0.; 3]]), wrong, "gravity has 1");
    assert_refused(
        batch.read(None, Field::Position, &mut [0.; 5]),
        wrong,
        "5 elements",
    );
    assert_refused(batch.world(2).map(drop), Status::NotFound, "world is 2");
    assert_refused(
        Batch::<f32>::new(&desc(3, 2), &Params::default(), 0).map(drop),
        wrong,
        "worlds is 0",
    );
}

#[test]
fn worlds_and_batches_go_in_any_order() {
    let mut batch = Batch::<f32>::new(&desc(3, 2), &Params::default(), 2).unwrap();
    batch.add_particles(&[1, 1], &[0.5; 6], None).unwrap();
    let reader = {
        let mut world = batch.world(0).unwrap();
        world.begin_step(u32::MAX).unwrap();
        world.reader()
    }; // its steps ended
    batch.step(None, 1).unwrap();
    drop(batch);
    reader.cancel().unwrap(); // the batch lives on for it
}

#[test]
fn a_panic_of_the_log_in_a_batch_goes_on_after_the_call() {
    let mut params = Params::default();
    params.time_step = 0.5; // which the log is told of
    let desc = desc(3, 1).with_log(|_, sentence| panic!("{sentence}"));
    let mut batch = Batch::<f32>::new(&desc, &params, 3).unwrap();
    batch.add_particles(&[1; 3], &[0.5; 9], None).unwrap();
    let panic = catch_unwind(AssertUnwindSafe(|| batch.step(None, 1))).unwrap_err();
    let sentence = panic.downcast_ref::<String>().unwrap();
    assert!(sentence.contains("time_step"), "{sentence}");
    batch.step(None, 1).unwrap();
}

/// A batch that nothing drops before the process ends.
#[test]
fn the_process_may_end_with_a_batch() {
    let mut batch = Batch::<f32>::new(&desc(3, 1), &Params::default(), 2).unwrap();
    batch.world(0).unwrap().step(1).unwrap();
    std::mem::forget(batch);
}

#[test]
fn fields_are_read_as_renderers_want_them() {
    let mut params = Params::default();
    params.gravity = [0.; 3];
    let mut fluid = Solver::<f64>::new(&desc(3, 10), &params).unwrap();
    fluid
        .add_particles(
            &[0.25, 0.5, 0.5, 0.75, 0.5, 0.5],
            Some(&[3., 0., -4., 0., 0., 0.]),
        )
        .unwrap();
    fluid.keep_previous(true).unwrap();
    fluid.step(1).unwrap();
    let speeds = Rows {
        components: 4,
        stride: 5,
        w: pbf::sys::PBF_W_SPEED,
        ..Rows::default()
    };
    let mut rows = [9f32; 10];
    fluid.read(Field::Position, &speeds, &mut rows).unwrap();
    near(0.25 + 3. * params.time_step, rows[0].into(), 1e-6);
    assert_eq!((rows[3], rows[4], rows[5], rows[9]), (5., 9., 0.75, 9.));
    let before = Rows {
        behind: 1.,
        ..Rows::default()
    };
    let mut x = [0f64; 6];
    fluid.read(Field::Position, &before, &mut x).unwrap();
    assert_eq!(x, [0.25, 0.5, 0.5, 0.75, 0.5, 0.5]);
    fluid
        .read(Field::Position, &speeds, &mut rows[..9])
        .unwrap(); // the last gap may be missing
    let wrong = Status::InvalidArgument;
    assert_refused(
        fluid.read(Field::Position, &speeds, &mut rows[..8]),
        wrong,
        "8 numbers",
    );
    assert_refused(
        fluid.read(Field::Position, &before, &mut x[..4]),
        wrong,
        "4 numbers",
    );
    for (has, stride) in [(1, 5), (5, usize::MAX), (10, 7)] {
        let odd = Rows { stride, ..speeds };
        assert_refused(
            fluid.read(Field::Position, &odd, &mut rows[..has]),
            wrong,
            "no rows of 4",
        );
    }
    let narrow = Rows {
        stride: 2,
        ..Rows::default()
    };
    assert_refused(
        fluid.read(Field::Position, &narrow, &mut x),
        wrong,
        "rows of 3 with 2",
    );
    let more = Rows {
        first: 1,
        ..Rows::default()
    };
    assert_refused(fluid.read(Field::Position, &more, &mut x), wrong, "");
}

/// Inside a fluid at rest particles are balls; alone they are half as large.
#[test]
fn anisotropies_are_of_the_neighbours() {
    let mut fluid = block();
    let (mut x, mut stretches) = ([0f32; 3], [0f32; 9]);
    let inner = Anisotropy {
        first: 555,
        ..Anisotropy::default()
    };
    fluid
        .anisotropies(&inner, Some(&mut x), Some(&mut stretches))
        .unwrap();
    near(0.275, x[0].into(), 1e-6);
    for (k, &number) in stretches.iter().enumerate() {
        near(f64::from(u8::from(k % 4 == 0)), number.into(), 0.02);
    }
    fluid.add_particles(&[0.9; 3], None).unwrap_err(); // full
    fluid.set_positions(0, &[0.9; 3]).unwrap();
    let lone = Anisotropy::default();
    fluid
        .anisotropies(&lone, None, Some(&mut stretches))
        .unwrap();
    near(0.5, stretches[4].into(), 1e-6);
    let refused = fluid.anisotropies(&lone, Some(&mut [0.; 6]), Some(&mut stretches));
    assert_refused(
        refused,
        Status::InvalidArgument,
        "positions has 2 rows, stretches 1",
    );
}
