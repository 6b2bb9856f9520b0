// Godot 4 (C#): a tank of water in a MultiMeshInstance3D, a child of this node. Reference Pbf.csproj, and put
// libpbf.so with the backends (libpbf_*.so) beside the exported program, or set LD_LIBRARY_PATH for the editor.
using Godot;
using Pbf;

public partial class Fluid : Node3D
{
    [Export] public Godot.Vector3 Tank = new Godot.Vector3(4, 2, 2);
    [Export] public float Spacing = 0.1f;

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
            fluid = new Solver(new Desc { Capacity = (uint)(nx * ny * nz) }, parameters);
            fluid.AddParticles(positions);
        }
        catch (PbfException exception)
        {
            GD.PushError(exception.Message);
            return;
        }
        drops = GetNode<MultiMeshInstance3D>("Drops").Multimesh;
        drops.InstanceCount = nx * ny * nz;
    }

    public override void _PhysicsProcess(double delta)
    {
        if (drops == null) return;
        debt = System.Math.Min(debt + delta, 0.1); // what can't be kept up with is dropped
        uint steps = (uint)(debt / timeStep);
        if (steps == 0) return;
        debt -= steps * timeStep;
        fluid.Step(steps);
        fluid.GetPositions(positions);
        for (int i = 0; i < drops.InstanceCount; ++i)
        {
            var at = new Godot.Vector3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
            drops.SetInstanceTransform(i, new Transform3D(Basis.Identity, at));
        }
    }

    public override void _ExitTree() { fluid?.Dispose(); }
}
