// Unity: a tank of water, drawn as instanced spheres. Put Pbf.dll (or the sources) into Assets, and libpbf.so
// with the backends (libpbf_*.so) into Assets/Plugins/x86_64; give the component a mesh and a material with
// "Enable GPU Instancing".
using System;
using System.Collections.Generic;
using Pbf;
using UnityEngine;

public sealed class FluidBehaviour : MonoBehaviour
{
    public Mesh particleMesh;
    public Material particleMaterial;
    public Vector3 tank = new Vector3(4, 2, 2);
    public float spacing = 0.1f;
    public Transform ball; // pushed through the water where it is moved
    public float ballRadius = 0.4f;
    public MeshFilter rock; // a closed mesh, readable, which stands in the water

    private const float LongestDebt = 0.1f; // seconds: what can't be kept up with is dropped
    private const int Batch = 1023;         // instances of one draw

    private Solver fluid;
    private Params parameters;
    private float debt;
    private float[] positions = new float[0];
    private Shape rockShape;
    private readonly List<Matrix4x4> matrices = new List<Matrix4x4>(Batch);

    private void OnEnable()
    {
        try
        {
            Fill();
        }
        catch (Exception exception) // a PbfException says what is wrong; also no library, no backend
        {
            Debug.LogException(exception, this);
            enabled = false;
        }
    }

    private void Fill()
    {
        parameters = Params.Default;
        parameters.Spacing = spacing;
        parameters.SmoothingRadius = 2 * spacing;
        parameters.TimeStep = 1.0 / 120;
        parameters.DomainMax = new Vector3d(tank.x, tank.y, tank.z);
        int nx = (int)(tank.x / 3 / spacing), ny = (int)(tank.y / 2 / spacing), nz = (int)(tank.z / spacing);
        var start = new float[3 * nx * ny * nz];
        for (int i = 0; i < nx * ny * nz; ++i)
        {
            start[3 * i] = (i % nx + 0.5f) * spacing;
            start[3 * i + 1] = (i / nx % ny + 0.5f) * spacing;
            start[3 * i + 2] = (i / (nx * ny) + 0.5f) * spacing;
        }
        var desc = new Desc { Capacity = (uint)(nx * ny * nz), Log = (level, sentence) => Debug.LogWarning(sentence) };
        fluid = new Solver(desc, parameters);
        fluid.AddParticles(start);
        positions = start;
        if (rock != null) rockShape = ShapeOf(rock);
        fluid.SetColliders(Colliders());
    }

    // In the space of this component, as all of the fluid is.
    private Shape ShapeOf(MeshFilter filter)
    {
        Vector3[] vertices = filter.sharedMesh.vertices;
        var places = new double[3 * vertices.Length];
        for (int i = 0; i < vertices.Length; ++i)
        {
            Vector3 at = transform.InverseTransformPoint(filter.transform.TransformPoint(vertices[i]));
            places[3 * i] = at.x;
            places[3 * i + 1] = at.y;
            places[3 * i + 2] = at.z;
        }
        return Shape.FromMesh(3, places, Array.ConvertAll(filter.sharedMesh.triangles, index => (uint)index), spacing / 2);
    }

    // The same ones, in the same order, each time.
    private Pbf.Collider[] Colliders()
    {
        var colliders = new List<Pbf.Collider>();
        if (rockShape != null) colliders.Add(Pbf.Collider.Solid(rockShape, new Vector3d(0, 0, 0)));
        if (ball != null) colliders.Add(BallCollider());
        return colliders.ToArray();
    }

    private void OnDisable()
    {
        if (fluid != null) fluid.Dispose();
        if (rockShape != null) rockShape.Dispose();
        fluid = null;
        rockShape = null;
    }

    private void Update()
    {
        if (fluid == null) return;
        debt = Mathf.Min(debt + Time.deltaTime, LongestDebt);
        int steps = Mathf.FloorToInt(debt / (float)parameters.TimeStep);
        if (steps > 0)
        {
            debt -= steps * (float)parameters.TimeStep;
            if (ball != null) fluid.MoveColliders(Colliders(), steps * parameters.TimeStep);
            fluid.Step((uint)steps);
            fluid.GetPositions(positions);
        }
        Draw();
    }

    private Pbf.Collider BallCollider()
    {
        Vector3 at = transform.InverseTransformPoint(ball.position);
        return Pbf.Collider.Sphere(new Vector3d(at.x, at.y, at.z), ballRadius);
    }

    private void Draw()
    {
        Matrix4x4 world = transform.localToWorldMatrix;
        Vector3 size = Vector3.one * spacing;
        for (int i = 0; i < positions.Length; i += 3)
        {
            var at = new Vector3(positions[i], positions[i + 1], positions[i + 2]);
            matrices.Add(world * Matrix4x4.TRS(at, Quaternion.identity, size));
            if (matrices.Count == Batch || i + 3 == positions.Length)
            {
                Graphics.DrawMeshInstanced(particleMesh, 0, particleMaterial, matrices);
                matrices.Clear();
            }
        }
    }
}
