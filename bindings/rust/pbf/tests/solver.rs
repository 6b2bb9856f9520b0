//! The crate against the library; the backend is that of PBF_TEST_BACKEND, or "auto".
use pbf::{Collider, Desc, Error, Field, Level, Params, Solver, Status};
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

fn desc() -> Desc {
    let backend = std::env::var("PBF_TEST_BACKEND").unwrap_or_else(|_| "auto".into());
    Desc {
        backend,
        capacity: 100,
        threads: 2,
        ..Default::default()
    }
}

fn filled() -> Solver<f32> {
    let mut fluid = Solver::new(&desc(), &Params::default()).unwrap();
    assert_eq!(
        fluid
            .add_particles(&[0.5, 0.5, 0.5, 0.6, 0.5, 0.5], None)
            .unwrap(),
        0
    );
    fluid
}

/// Its log is told that the time step is too long.
fn falling_too_fast(desc: &Desc) -> Solver<f32> {
    let mut params = Params::default();
    params.time_step = 0.5;
    let mut fluid = Solver::new(desc, &params).unwrap();
    fluid.add_particles(&[0.5, 0.5, 0.5], None).unwrap();
    fluid
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
fn a_particle_falls() {
    let mut params = Params::default();
    params.time_step = 1. / 128.;
    let mut fluid = Solver::<f64>::new(&desc(), &params).unwrap();
    fluid.add_particles(&[0.5, 0.5, 0.5], None).unwrap();
    fluid.step(16).unwrap();
    // n steps of symplectic Euler: g dt^2 n (n + 1) / 2
    let fallen = params.gravity[1] / (128. * 128.) * 16. * 17. / 2.;
    assert!((fluid.positions().unwrap()[1] - (0.5 + fallen)).abs() < 1e-9);
    assert!((fluid.velocities().unwrap()[1] - params.gravity[1] / 8.).abs() < 1e-9);
    assert_eq!(fluid.info().unwrap().step, 16);
    assert_eq!(fluid.stats().unwrap().count, 1);
    assert_eq!(fluid.ids().unwrap(), [0]);
    assert_eq!(fluid.find_in_box([0.; 3], [1.; 3]).unwrap(), [0]);
    assert_eq!(fluid.remove_in_box([0.; 3], [1.; 3]).unwrap(), 1);
    assert_eq!(fluid.count().unwrap(), 0);
}

/// What walls and colliders have had is the momentum that gravity gave and the fluid has not.
#[test]
fn loads_are_the_momentum_that_is_gone() {
    let mut params = Params::default();
    params.loads = 1;
    let mut fluid = Solver::<f64>::new(&desc(), &params).unwrap();
    assert!(fluid.collider_loads().unwrap().is_empty());
    fluid
        .add_particles(&[0.5, 0.06, 0.5, 0.56, 0.06, 0.5], None)
        .unwrap();
    fluid
        .set_colliders(&[Collider::sphere([0.9; 3], 0.05)])
        .unwrap();
    fluid.step(16).unwrap();
    let far = fluid.collider_loads().unwrap();
    let walls = fluid.wall_loads().unwrap();
    assert_eq!((far.len(), walls.len()), (1, 6));
    let v = fluid.velocities().unwrap();
    let (volume, time) = (
        (params.smoothing_radius / 2.).powi(3),
        16. * params.time_step,
    );
    let gone = volume * (2. * params.gravity[1] * time - v[1] - v[4]);
    let floor = &walls[pbf::sys::PBF_WALL_Y_MIN as usize];
    assert!(gone < -0.5 * volume);
    assert!((floor.impulse_sum[1] / gone - 1.).abs() < 1e-9);
    assert!((floor.time_sum - time).abs() < 1e-12);
    assert_eq!((far[0].contacts, far[0].impulse_sum), (0, [0.; 3]));
    params.loads = 0;
    fluid.set_params(&params).unwrap();
    assert_refused(fluid.wall_loads().map(|_| ()), Status::State, "loads");
}

#[test]
fn accelerations_hold_up() {
    let mut fluid = filled();
    fluid.set_accelerations(1, &[0., 9.81, 0.]).unwrap();
    fluid.step(12).unwrap();
    let v = fluid.velocities().unwrap();
    assert!((v[1] + 0.981).abs() < 1e-4 && v[4].abs() < 1e-6);
    let saved = fluid.save().unwrap();
    fluid.clear_accelerations().unwrap();
    fluid.step(12).unwrap();
    assert!((fluid.velocities().unwrap()[4] + 0.981).abs() < 1e-4);
    fluid.load(&saved).unwrap();
    fluid.step(12).unwrap();
    assert!(fluid.velocities().unwrap()[4].abs() < 1e-5);
}

#[test]
fn errors_have_the_sentence() {
    let mut params = Params::default();
    params.time_step = -1.;
    assert_refused(
        Solver::<f32>::new(&desc(), &params),
        Status::InvalidArgument,
        "time_step",
    );
    let plane = Desc {
        dimension: 4,
        ..desc()
    };
    assert_refused(
        Solver::<f32>::new(&plane, &Params::default()),
        Status::InvalidArgument,
        "dimension",
    );
    let zero = Desc {
        backend: "ser\0ial".into(),
        ..desc()
    };
    assert_refused(
        Solver::<f32>::new(&zero, &Params::default()),
        Status::InvalidArgument,
        "zero byte",
    );
    let mut fluid = filled();
    assert_refused(
        fluid.add_particles(&[0.5; 4], None),
        Status::InvalidArgument,
        "4 numbers",
    );
    assert_refused(
        fluid.add_particles(&[0.5; 3], Some(&[0.; 6])),
        Status::InvalidArgument,
        "velocities",
    );
    assert_refused(
        fluid.add_particles(&[f32::NAN; 3], None),
        Status::InvalidArgument,
        "NaN",
    );
    assert_refused(
        fluid.read_positions(0, &mut [0.; 9]),
        Status::InvalidArgument,
        "3",
    );
    assert_refused(fluid.load(&[1, 2, 3]), Status::Data, "");
    assert_eq!(fluid.count().unwrap(), 2);
}

#[test]
fn struct_sizes_are_set() {
    let mut params = Params::default();
    params.struct_size = 1 << 30;
    let mut fluid = Solver::<f32>::new(&desc(), &params).unwrap();
    fluid.set_params(&params).unwrap();
    let mut ball = Collider::sphere([0.5; 3], 0.1);
    ball.struct_size = 1 << 30;
    fluid
        .set_colliders(&[ball, Collider::cuboid([0.; 3], [0.1; 3])])
        .unwrap();
    assert_eq!(fluid.colliders().unwrap()[1].half_extents, [0.1; 3]);
}

#[test]
fn views_are_of_the_particles() {
    let mut fluid = filled();
    let view = fluid.map(Field::Position).unwrap();
    assert_eq!((view.len(), view.components()), (2, 3));
    if view.on_host() {
        let first = view.ids().iter().position(|&id| id == 0).unwrap();
        assert_eq!((view.at(first, 0), view.at(1 - first, 0)), (0.5, 0.6));
        if let Some(x) = view.component(0) {
            assert_eq!(x[1 - first], 0.6);
        }
        assert!(catch_unwind(AssertUnwindSafe(|| view.at(2, 0))).is_err());
    }
    drop(view);
    fluid.step(1).unwrap();
    std::mem::forget(fluid.map(Field::Velocity).unwrap());
    assert_refused(fluid.step(1), Status::State, "map");
}

#[test]
fn a_snapshot_outlives_its_solver_in_another_thread() {
    let mut fluid = filled();
    fluid.set_snapshots(2).unwrap();
    let snapshot = fluid.snapshot().unwrap();
    drop(fluid);
    let x = std::thread::spawn(move || snapshot.positions()[3])
        .join()
        .unwrap();
    assert_eq!(x, 0.6);
}

#[test]
fn readers_cancel_and_outlive() {
    let mut fluid = filled();
    let reader = fluid.reader();
    fluid.begin_step(u32::MAX).unwrap();
    assert_refused(fluid.count(), Status::Busy, "");
    let other = reader.clone();
    std::thread::spawn(move || other.cancel().unwrap())
        .join()
        .unwrap();
    assert_refused(fluid.end_step(), Status::Cancelled, "");
    fluid.begin_step(u32::MAX).unwrap();
    let raw = fluid.as_raw();
    drop(fluid); // cancelled and waited for, though the reader still has the solver
    assert_eq!(
        unsafe { pbf::sys::pbf_get_count(raw, &mut 0) },
        pbf::sys::PBF_OK
    );
    reader.cancel().unwrap();
    assert_refused(reader.snapshot(), Status::State, "snapshot");
}

#[test]
fn a_solver_goes_to_another_thread() {
    let mut fluid = filled();
    let mut fluid = std::thread::spawn(move || {
        fluid.step(3).unwrap();
        fluid
    })
    .join()
    .unwrap();
    fluid.step(2).unwrap();
    assert_eq!(fluid.info().unwrap().step, 5);
}

#[test]
fn states_go_on_alike() {
    let (mut one, mut other) = (
        filled(),
        Solver::<f32>::new(&desc(), &Params::default()).unwrap(),
    );
    one.step(5).unwrap();
    other.load(&one.save().unwrap()).unwrap();
    one.step(5).unwrap();
    other.step(5).unwrap();
    assert_eq!(one.hash().unwrap(), other.hash().unwrap());
}

#[test]
fn the_log_is_heard() {
    let heard = Arc::new(Mutex::new(Vec::new()));
    let to = heard.clone();
    let desc = desc()
        .with_log(move |level, sentence| to.lock().unwrap().push((level, sentence.to_string())));
    falling_too_fast(&desc).step(1).unwrap();
    let heard = heard.lock().unwrap();
    assert_eq!(heard[0].0, Level::Warning);
    assert!(heard[0].1.contains("time_step"), "{}", heard[0].1);
}

#[test]
fn a_panic_of_the_log_goes_on_after_the_call() {
    let calls = Arc::new(AtomicUsize::new(0));
    let counted = calls.clone();
    let desc = desc().with_log(move |_, _| {
        counted.fetch_add(1, Ordering::SeqCst);
        panic!("the log panics");
    });
    let mut fluid = falling_too_fast(&desc);
    let panic = catch_unwind(AssertUnwindSafe(|| fluid.step(1))).unwrap_err();
    assert_eq!(*panic.downcast_ref::<&str>().unwrap(), "the log panics");
    assert_eq!(calls.load(Ordering::SeqCst), 1);
    fluid.step(1).unwrap(); // the step was made, and the solver goes on
    assert_eq!(fluid.info().unwrap().step, 2);

    let mut fluid = falling_too_fast(&desc);
    fluid.begin_step(1).unwrap();
    assert!(catch_unwind(AssertUnwindSafe(|| fluid.end_step())).is_err());
    let mut fluid = falling_too_fast(&desc);
    fluid.begin_step(1).unwrap();
    drop(fluid);
}

#[test]
fn plans_and_backends_are_told() {
    let mut fluid = filled();
    let plan = fluid.plan().unwrap();
    assert!(
        plan.stages.iter().any(|stage| stage.name == "predict"),
        "{plan:?}"
    );
    assert!(plan.arrays.iter().all(|array| !array.name.is_empty()));
    fluid.set_timing(true).unwrap();
    fluid.step(1).unwrap();
    assert!(!fluid.timings().unwrap().is_empty());
    assert!(pbf::backends(&desc())
        .unwrap()
        .iter()
        .any(|backend| backend.available));
    assert_eq!(pbf::version().0, pbf::sys::PBF_VERSION_MAJOR);
}

/// A solver that nothing drops before the process ends.
#[test]
fn the_process_may_end_with_a_solver() {
    let mut fluid = filled();
    fluid.begin_step(u32::MAX).unwrap();
    std::mem::forget(fluid);
}

static LOGS_GONE: AtomicU32 = AtomicU32::new(0);

/// What a log has for its own.
struct Held;
impl Drop for Held {
    fn drop(&mut self) {
        LOGS_GONE.fetch_add(1, Ordering::SeqCst);
    }
}

#[test]
fn a_log_of_begun_steps_drops_its_solver() {
    let slot: Arc<Mutex<Option<Solver<f32>>>> = Arc::default();
    let (taken, told) = (slot.clone(), Arc::new(AtomicU32::new(0)));
    let (held, heard) = (Held, told.clone());
    let mut params = Params::default();
    params.time_step = 0.5;
    params.attraction = 20.; // steps are too long for both
    let mut fluid = Solver::<f32>::new(
        &desc().with_log(move |_, _| {
            let _own = &held;
            drop(taken.lock().unwrap().take());
            // While it runs it has what it holds.
            heard.fetch_add(1 + 100 * LOGS_GONE.load(Ordering::SeqCst), Ordering::SeqCst);
        }),
        &params,
    )
    .unwrap();
    fluid.add_particles(&[0.5, 0.5, 0.5], None).unwrap();
    let mut held_back = slot.lock().unwrap();
    fluid.begin_step(u32::MAX).unwrap();
    *held_back = Some(fluid);
    drop(held_back);
    while LOGS_GONE.load(Ordering::SeqCst) == 0 {
        std::thread::yield_now();
    }
    assert_eq!(told.load(Ordering::SeqCst), 1);
}
