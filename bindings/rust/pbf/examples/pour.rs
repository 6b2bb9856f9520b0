//! A tap pours water over a stone; after three seconds: how much has come and gone, how high it stands, what it weighs.
/* code: pour */
use pbf::{Collider, Desc, Emitter, Params, Samples, Shape, Solver, Volume};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut params = Params::default();
    params.loads = 1; // what the water does to solids
    let desc = Desc {
        capacity: 3000,
        ..Default::default()
    };
    let mut fluid = Solver::<f32>::new(&desc, &params)?;

    let tips = [
        0.2, 0., 0., -0.2, 0., 0., 0., 0.2, 0., 0., -0.2, 0., 0., 0., 0.2, 0., 0., -0.2,
    ];
    let stone = Shape::from_points(3, &tips, 0.025)?;
    fluid.set_colliders(&[Collider::solid(&stone, [0.5, 0.1, 0.5])])?;
    fluid.set_emitters(&[Emitter::disc([0.5, 0.9, 0.5], [0., -1., 0.], 0.15)])?;
    fluid.set_drains(&[Volume::cuboid([0.95, 0.5, 0.5], [0.05, 0.3, 0.5])])?; // an overflow at 0.2
    fluid.step((2.5 / params.time_step) as u32)?;
    fluid.wall_loads()?; // begins the sums anew
    fluid.step((0.5 / params.time_step) as u32)?;

    let (came, went) = (fluid.in_out()?.emitted, fluid.in_out()?.drained);
    let level = fluid.levels(&[0.1, 0., 0.1])?[0];
    let floor = fluid.wall_loads()?[pbf::sys::PBF_WALL_Y_MIN as usize];
    let weight = -1000. * floor.impulse_sum[1] / floor.time_sum; // water has 1000 kg/m³
    let mut density = [0.];
    fluid.sample(
        &[0.1, 0.1, 0.1],
        Samples {
            densities: Some(&mut density),
            ..Default::default()
        },
    )?;
    println!(
        "{came} came, {went} went, {level:.2} m high, {weight:.0} N on the floor, density {:.1}",
        density[0]
    );
    Ok(())
}
/* end */
