/* Of PE, Windows' format. The system checks an image before it maps it, and refuses one that is cut
 * short; so this finds sentences alone. */
#include "image.h"

#include <string.h>

#include "os.h"

enum { DOS_BYTES = 64, PE_BYTES = 24, SECTION_BYTES = 40, MAX_SECTIONS = 96, IS_LIBRARY = 0x2000 };

static unsigned two(const unsigned char *bytes) { return bytes[0] | (unsigned)bytes[1] << 8; }

static uint32_t four(const unsigned char *bytes) {
  return two(bytes) | (uint32_t)two(bytes + 2) << 16;
}

static const char *machine_name(unsigned machine) {
  static const struct {
    unsigned machine;
    const char *name;
  } known[] = {{0x014c, "x86"}, {0x8664, "x86-64"}, {0x01c4, "Arm"}, {0xaa64, "AArch64"}};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; ++i)
    if (known[i].machine == machine) return known[i].name;
  return "an unknown one";
}

static pbf_status refuse(pbf_plugin *plugin, const char *why) {
  return pbf_plugin_refuse(plugin, PBF_ERROR_UNAVAILABLE, "%s", why);
}

static int is_image(const unsigned char *header) { return memcmp(header, "PE\0\0", 4) == 0; }

/* This library's own, which the loader has mapped with it. */
static unsigned own_machine(void) {
  const unsigned char *own = pbf_os_own_image();
  return own ? two(own + four(own + 60) + 4) : 0;
}

static pbf_status check_header(const unsigned char *header, pbf_plugin *plugin) {
  const unsigned theirs = two(header + 4), own = own_machine();
  if (!is_image(header)) return refuse(plugin, "it is no DLL: it is a program of DOS");
  if (own && theirs != own)
    return pbf_plugin_refuse(plugin, PBF_ERROR_UNAVAILABLE,
                             "it is for another architecture, %s; this process is %s",
                             machine_name(theirs), machine_name(own));
  if (!(two(header + 22) & IS_LIBRARY)) return refuse(plugin, "it is a program, and no DLL");
  return PBF_OK;
}

/* The sections' headers follow what the header says is optional. */
static pbf_status check_sections(int file, uint64_t size, uint64_t from,
                                 const unsigned char *header, pbf_plugin *plugin) {
  unsigned char sections[MAX_SECTIONS * SECTION_BYTES];
  const unsigned count = two(header + 6);
  const uint64_t place = from + PE_BYTES + two(header + 20);
  if (count > MAX_SECTIONS) return refuse(plugin, "it is damaged: it has too many sections");
  if (!pbf_os_read(file, sections, count * SECTION_BYTES, place))
    return refuse(plugin, "it is cut short: its headers lie beyond its end");
  for (unsigned k = 0; k < count; ++k) {
    const unsigned char *one = sections + k * SECTION_BYTES;
    if ((uint64_t)four(one + 16) + four(one + 20) > size && four(one + 16))
      return refuse(plugin, "it is cut short: its sections lie beyond its end");
  }
  return PBF_OK;
}

pbf_status pbf_image_check(int file, uint64_t size, pbf_plugin *plugin) {
  unsigned char dos[DOS_BYTES], header[PE_BYTES];
  if (size == 0) return refuse(plugin, "it is empty");
  if (!pbf_os_read(file, dos, 2, 0) || memcmp(dos, "MZ", 2) != 0)
    return refuse(plugin, "it is no DLL: it does not begin as one");
  if (!pbf_os_read(file, dos, sizeof dos, 0) ||
      !pbf_os_read(file, header, sizeof header, four(dos + 60)))
    return refuse(plugin, "it is cut short: its headers lie beyond its end");
  pbf_status status = check_header(header, plugin);
  return status == PBF_OK ? check_sections(file, size, four(dos + 60), header, plugin) : status;
}
