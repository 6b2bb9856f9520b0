-- What the module's parts have in common: the library, errors, and values on their way to C.
local ffi = require("ffi")
local layouts = require("pbf.cdef")

local function load_library()
  local named = os.getenv("PBF_LIBRARY")
  if named then return ffi.load(named) end
  local found, library = pcall(ffi.load, "pbf")
  return found and library or ffi.load("libpbf.so.0.2") -- without its development files
end
local C = load_library()

local Error = {}
Error.__index = Error
Error.__tostring = function(self) return self.message end

local function failure(status, message)
  return setmetatable({ status = status, name = ffi.string(C.pbf_status_string(status)), message = message }, Error)
end

local function fail(status, message) error(failure(status, message), 0) end

local function invalid(...) fail(C.PBF_ERROR_INVALID_ARGUMENT, string.format(...)) end

-- Not compiled: what it calls may call the log, and a compiled trace can't be called back into.
local function call(name, ...)
  local status = C[name](...)
  if status ~= 0 then fail(status, ffi.string(C.pbf_last_error())) end
end
jit.off(call)

-- A new struct, with its size.
local function new(struct) return ffi.new(struct, { struct_size = ffi.sizeof(struct) }) end

local function shown(value)
  return type(value) == "string" and string.format("%q", value) or tostring(value)
end

local function need(kind, what, value, wanted)
  if type(value) ~= kind then invalid("%s is %s; it must be %s", what, shown(value), wanted) end
  return value
end

-- LuaJIT makes some integer of any number: 2^32 - 1 of -1.
local function unsigned(what, value)
  local number = type(value) == "cdata" and tonumber(value) or value
  if type(number) ~= "number" or number % 1 ~= 0 or number < 0 or number > 4294967295 then
    invalid("%s is %s; it must be an integer, 0 … 4294967295", what, shown(value))
  end
  return number
end

-- A string for C, where it ends at its first zero.
local function c_string(what, value)
  if value:find("\0", 1, true) then invalid("%s has a zero in it: %s", what, shown(value)) end
  return value
end

-- Puts a value where C has a field or an element. What does not come back as it was given does not fit there.
local function put(what, place, name, value)
  if type(value) == "string" then c_string(what, value) end
  local done = pcall(function() place[name] = value end)
  if not done then invalid("%s is %s, which is no value for it", what, shown(value)) end
  local kept = place[name]
  if type(value) == "number" and type(kept) == "number" and kept ~= value and (kept == kept or value == value) then
    invalid("%s is %s; it must be an integer that its field can hold", what, shown(value))
  end
end

-- How many elements a field has that is an array, from the name of its type; else nil.
local function array_length(field)
  return type(field) == "cdata" and tonumber(tostring(ffi.typeof(field)):match("%[(%d+)%]")) or nil
end

-- Fields of a struct from a table; `what` is what the library calls the struct.
local function assign(what, struct, fields)
  if fields == nil then return struct end
  for name, value in pairs(need("table", what, fields, "a table")) do
    local field = what .. "." .. tostring(name)
    if type(name) ~= "string" or not ffi.offsetof(struct, name) then invalid("there is no %s", field) end
    local length = array_length(struct[name])
    if length and type(value) ~= "cdata" then
      need("table", field, value, string.format("a table of at most %d numbers", length))
      if #value > length then invalid("%s has %d numbers, and at most %d", field, #value, length) end
      for i = 1, #value do put(string.format("%s[%d]", field, i), struct[name], i - 1, value[i]) end
    else
      put(field, struct, name, value)
    end
  end
  return struct
end

local function flat(values)
  if type(values[1]) ~= "table" then return values end
  local numbers = {}
  for _, row in ipairs(values) do
    for _, number in ipairs(row) do numbers[#numbers + 1] = number end
  end
  return numbers
end

-- An array of C tells what it holds, and how much; a pointer only what, unless it is of void. LuaJIT would take the
-- address of a struct, and an integer for one.
local function fits(what, element, values, numbers)
  local kind = tostring(ffi.typeof(values)):gsub("^ctype<", ""):gsub(">$", ""):gsub("const ", "")
  local plain = kind:gsub("%(&%)", ""):gsub("%(%*%)%[.*$", "*") -- what a field is, and a pointer to rows
  local holds, mark = plain:match("^(.-) ([%[*])")
  if not holds or plain:find("%*.") or tostring(values):find("^ctype<") then
    invalid("%s is a %s; it must be an array of %s, or a pointer", what, kind, element)
  end
  if mark == "*" and holds == "void" then return end
  if not (holds == element or (element == "uint32_t" and holds == "unsigned int")) then
    invalid("%s holds %s; it must hold %s", what, holds, element)
  end
  if mark == "*" then return end
  local has = ffi.sizeof(values) / ffi.sizeof(element)
  if has < numbers then invalid("%s has %d numbers, and %d are wanted", what, has, numbers) end
end

-- A C array and how many rows it has, of a table of numbers, of tables of numbers, or of an array of C with
-- its number of rows.
local function rows_of(what, element, components, values, count)
  if type(values) == "cdata" then
    if not count then invalid("%s is an array of C: how many rows has it?", what) end
    fits(what, element, values, components * unsigned("count", count))
    return ffi.cast(string.format("const %s *", element), values), tonumber(count)
  end
  local numbers = flat(need("table", what, values, "a table, or an array of C"))
  for i, number in ipairs(numbers) do
    if element == "uint32_t" then unsigned(string.format("%s[%d]", what, i), number)
    else need("number", string.format("a number of %s", what), number, "a number") end
  end
  if #numbers % components ~= 0 then
    invalid("%s has %d numbers, no multiple of %d", what, #numbers, components)
  end
  return ffi.new(element .. "[?]", #numbers, numbers), #numbers / components
end


-- A table of a struct's fields, as assign takes it.
local function fields_of(struct, from)
  local fields = {}
  for name in pairs(layouts[struct]) do
    if name ~= "size" and name ~= "struct_size" and name ~= "reserved" then
      local value = from[name]
      local length = array_length(value)
      if length then
        fields[name] = {}
        for i = 1, length do fields[name][i] = value[i - 1] end
      else
        fields[name] = value
      end
    end
  end
  return fields
end

-- An array of structs of C, each begun by the function `init`, from a list of tables. `kinds`, where structs have
-- a shape, gives the number that one stands for, and fields that come with it.
local function structs_of(what, struct, init, kinds, list)
  need("table", what, list, "a list of tables")
  local array = ffi.new(struct .. "[?]", math.max(#list, 1))
  for i, fields in ipairs(list) do
    local copy, place = {}, string.format("%s[%d]", what, i)
    for name, value in pairs(need("table", place, fields, "a table")) do copy[name] = value end
    if kinds then
      local number, more = kinds(place .. ".shape", copy.shape)
      copy.shape = nil
      call(init, array[i - 1], ffi.sizeof(struct), number)
      assign(place, array[i - 1], more)
    else
      call(init, array[i - 1], ffi.sizeof(struct))
    end
    assign(place, array[i - 1], copy)
  end
  return array, #list
end

-- Shapes that are named: `kinds` for structs_of, and what gives the name back.
local function named(names)
  local known = table.concat(names, ", ")
  return function(what, shape)
    for i, name in ipairs(names) do
      if name == shape then return i - 1 end
    end
    invalid("%s is %s; known are: %s", what, tostring(shape), known)
  end, function(number) return names[number + 1] end
end

-- What is closed in a call, by its log or by what is called with a view, is destroyed when the call has returned.
local function enter(self)
  if not self.handle then invalid("the %s is closed", self.what) end
  self.inside = (self.inside or 0) + 1
  return self.handle
end

local function leave(self)
  self.inside = self.inside - 1
  local at_end = self.at_end
  if self.inside > 0 or not at_end then return end
  self.at_end = nil
  at_end()
end

-- Calls when no call is inside any of these, now or then.
local function when_left(objects, destroy)
  for object in pairs(objects) do
    if (object.inside or 0) > 0 then
      object.at_end = function() when_left(objects, destroy) end
      return
    end
  end
  destroy()
end

-- Calls with the object's handle; an error of the log goes on when the call has returned.
local function run(self, name, ...)
  local handle = enter(self)
  local done, why = pcall(call, name, handle, ...)
  leave(self)
  local thrown = self.thrown and self.thrown.error
  if thrown ~= nil then self.thrown.error = nil end
  if not done then error(why, 0) end
  if thrown ~= nil then error(thrown, 0) end
end

-- A number that the library writes.
local function number_of(self, ctype, name, ...)
  local number = ffi.new(ctype .. "[1]")
  local given = select("#", ...)
  local arguments = { ... }
  arguments[given + 1] = number
  run(self, name, unpack(arguments, 1, given + 1))
  return number[0]
end

-- Whatever is given here is not collected before.
local function alive() end
jit.off(alive)

return {
  C = C, Error = Error, failure = failure, invalid = invalid, call = call, new = new, need = need, c_string = c_string, unsigned = unsigned, assign = assign,
  rows_of = rows_of, fields_of = fields_of, structs_of = structs_of, named = named, enter = enter, leave = leave, when_left = when_left, run = run, number_of = number_of, alive = alive,
}
