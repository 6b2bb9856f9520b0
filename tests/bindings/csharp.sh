#!/bin/sh
# csharp.sh SOURCE LIBRARIES FOLDER: the assembly, its test and the samples, by Mono.
set -eu
source=$1 libraries=$2 folder=$3
for program in mcs mono; do
  command -v $program >/dev/null || { echo "skipped: no $program"; exit 77; }
done
csharp=$source/bindings/csharp
mkdir -p "$folder"
cd "$folder"
# Of what C# had when .NET Standard 2.0 came, and mscorlib alone.
mcs -langversion:7.2 -warnaserror -noconfig -target:library -out:Pbf.dll "$csharp"/Pbf/*.cs
mcs -langversion:7.2 -r:Pbf.dll -out:Binding.exe "$source/tests/bindings/Binding.cs" "$source/tests/bindings/Objects.cs" \
  "$source/tests/bindings/Runtime.cs"
mcs -r:Pbf.dll -out:Splash.exe "$csharp/samples/Splash.cs"
mcs -r:Pbf.dll -out:Pour.exe "$csharp/samples/Pour.cs"
mcs -warn:0 -target:library -r:Pbf.dll -out:Samples.dll "$source/tests/bindings/EngineStubs.cs" \
  "$csharp/samples/FluidBehaviour.cs" "$csharp/samples/Fluid.cs"
LD_LIBRARY_PATH=$libraries${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export LD_LIBRARY_PATH
mono Binding.exe
mono Splash.exe | tee printed
grep -q '1\.0 s: front at 1\.9' printed
mono Pour.exe | tee printed
grep -q ', 0\.2[3-6] m high, 2[01][0-9][0-9] N on the floor, density \(0\.9\|1\.0\)$' printed
