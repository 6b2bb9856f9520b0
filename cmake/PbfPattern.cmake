# pbf_pattern(<out> <folder>): the pattern that names this folder alone, which may have brackets in its name.
function(pbf_pattern out folder)
  string(REGEX REPLACE "([[*?])" "[\\1]" pattern "${folder}")
  set(${out} "${pattern}" PARENT_SCOPE)
endfunction()
