using System.Runtime.CompilerServices;

[assembly: InternalsVisibleTo("Binding")] // its test
