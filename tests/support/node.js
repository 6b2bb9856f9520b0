// Linked before the program: it has node's environment. Node's fetch reads no files.
Module["preRun"] = () => Object.assign(ENV, process.env);
delete globalThis.fetch;
