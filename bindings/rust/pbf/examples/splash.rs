//! A dam break: 4,000 particles fall and spread, the front is printed ten times a second.
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut params = pbf::Params::default();
    params.domain_max[0] = 2.; // a tank of 2 x 1 x 1, particles 0.05 apart
    let desc = pbf::Desc {
        capacity: 4000,
        ..Default::default()
    };
    let mut fluid = pbf::Solver::<f32>::new(&desc, &params)?;

    let mut positions = Vec::new();
    for (z, y, x) in (0..20 * 20 * 10).map(|i| (i / 200, i / 10 % 20, i % 10)) {
        positions.extend([x, y, z].map(|n| 0.025 + 0.05 * n as f32));
    }
    fluid.add_particles(&positions, None)?;

    for frame in 1..=10 {
        fluid.step((0.1 / params.time_step).round() as u32)?;
        println!(
            "{:.1} s: front at {:.2} m",
            0.1 * frame as f64,
            fluid.stats()?.position_max[0]
        );
    }
    Ok(())
}
