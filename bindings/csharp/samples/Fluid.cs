// Godot 4 (C#): a tank of water in a MultiMeshInstance3D, a child of this node. Reference Pbf.csproj, and put
// libpbf.so with the backends (libpbf_*.so) beside the exported program, or set LD_LIBRARY_PATH for the editor.
using Godot;
using Pbf;
using Math = System.Math;

public partial class Fluid : Node3D
{
    [Export] public Godot.Vector3 Tank = new Godot.Vector3(4, 2, 2);
    [Export] public float Spacing = 0.1f;
    [Export] public int Capacity = 20000; // a tap fills the tank up to so many particles

    private Solver fluid;
    private MultiMesh drops;
    private float[] positions;
    private double debt;
    private double timeStep;

    public override void _Ready()
    {
        var parameters = Params.Default;
        parameters.Spacing = Spacing;
        parameters.SmoothingRadius = 2 * Spacing;
        parameters.DomainMax = new Vector3d(Tank.X, Tank.Y, Tank.Z);
        timeStep = parameters.TimeStep;
        int nx = (int)(Tank.X / 3 / Spacing), ny = (int)(Tank.Y / 2 / Spacing), nz = (int)(Tank.Z / Spacing);
        positions = new float[3 * nx * ny * nz];
        for (int i = 0; i < nx * ny * nz; ++i)
        {
            positions[3 * i] = (i % nx + 0.5f) * Spacing;
            positions[3 * i + 1] = (i / nx % ny + 0.5f) * Spacing;
            positions[3 * i + 2] = (i / (nx * ny) + 0.5f) * Spacing;
        }
        try
        {
            fluid = new Solver(new Desc { Capacity = (uint)Math.Max(Capacity, nx * ny * nz) }, parameters);
            fluid.AddParticles(positions);
            var tap = new Vector3d(Tank.X * 0.75, Tank.Y - 2 * Spacing, Tank.Z / 2);
            fluid.SetEmitters(Emitter.Disc(tap, new Vector3d(0, -2, 0), 2 * Spacing));
        }
        catch (PbfException exception)
        {
            GD.PushError(exception.Message);
            return;
        }
        drops = GetNode<MultiMeshInstance3D>("Drops").Multimesh;
        drops.InstanceCount = Math.Max(Capacity, nx * ny * nz);
    }

    public override void _PhysicsProcess(double delta)
    {
        if (drops == null) return;
        debt = Math.Min(debt + delta, 0.1); // what can't be kept up with is dropped
        uint steps = (uint)(debt / timeStep);
        if (steps == 0) return;
        debt -= steps * timeStep;
        fluid.Step(steps);
        int count = (int)fluid.Count;
        if (positions.Length != 3 * count) positions = new float[3 * count];
        fluid.GetPositions(positions);
        drops.VisibleInstanceCount = count;
        for (int i = 0; i < count; ++i)
        {
            var at = new Godot.Vector3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
            drops.SetInstanceTransform(i, new Transform3D(Basis.Identity, at));
        }
    }

    public override void _ExitTree() { fluid?.Dispose(); }
}
