/* A buffer of Vulkan that a solver writes positions into, as a renderer would have it: memory and a
 * semaphore go to CUDA by file descriptors, pbf_read fills the one, the other is signalled behind
 * it, and Vulkan's queue waits for it and copies the buffer to where the host sees it. The host
 * waits for nothing in between. */
#include "driver.h"
#include "support.h"

#include <vulkan/vulkan.h>

enum { COUNT = 700, STEPS = 5 };
static const uint64_t bytes = COUNT * 4 * sizeof(float); /* quads, with the speed in w */

#define OK(call) assert_int_equal((call), VK_SUCCESS)

typedef struct gpu {
  VkInstance instance;
  VkPhysicalDevice physical;
  VkDevice device;
  uint32_t family;
  VkQueue queue;
  VkCommandPool pool;
} gpu;

typedef struct buffer {
  VkBuffer buffer;
  VkDeviceMemory memory;
} buffer;

/* ---- Vulkan ---------------------------------------------------------------------------------- */

/* That of CUDA's device 0; null: Vulkan does not have it. */
static VkPhysicalDevice find_device(VkInstance instance) {
  VkPhysicalDevice all[16];
  uint32_t count = sizeof all / sizeof all[0];
  unsigned char wanted[16];
  cuda_get_uuid(wanted);
  vkEnumeratePhysicalDevices(instance, &count, all);
  for (uint32_t k = 0; k < count; ++k) {
    VkPhysicalDeviceIDProperties id = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES};
    VkPhysicalDeviceProperties2 properties = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &id};
    vkGetPhysicalDeviceProperties2(all[k], &properties);
    if (memcmp(id.deviceUUID, wanted, sizeof wanted) == 0) return all[k];
  }
  return VK_NULL_HANDLE;
}

static void open_queue(gpu *g) {
  static const char *const extensions[] = {VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME,
                                           VK_KHR_EXTERNAL_SEMAPHORE_FD_EXTENSION_NAME};
  const float priority = 1;
  const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                         .queueFamilyIndex = g->family,
                                         .queueCount = 1,
                                         .pQueuePriorities = &priority};
  const VkDeviceCreateInfo device = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue,
                                     .enabledExtensionCount = 2,
                                     .ppEnabledExtensionNames = extensions};
  const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                        .queueFamilyIndex = g->family};
  OK(vkCreateDevice(g->physical, &device, NULL, &g->device));
  vkGetDeviceQueue(g->device, g->family, 0, &g->queue);
  OK(vkCreateCommandPool(g->device, &pool, NULL, &g->pool));
}

/* 0: there is no Vulkan, or not on CUDA's device. A queue family of any kind can copy. */
static int open_gpu(gpu *g) {
  const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                         .apiVersion = VK_API_VERSION_1_1};
  const VkInstanceCreateInfo instance = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                         .pApplicationInfo = &application};
  *g = (gpu){.family = 0};
  if (vkCreateInstance(&instance, NULL, &g->instance) != VK_SUCCESS) return 0;
  g->physical = find_device(g->instance);
  if (g->physical) {
    open_queue(g);
    return 1;
  }
  vkDestroyInstance(g->instance, NULL);
  return 0;
}

static void close_gpu(gpu *g) {
  vkDestroyCommandPool(g->device, g->pool, NULL);
  vkDestroyDevice(g->device, NULL);
  vkDestroyInstance(g->instance, NULL);
}

static uint32_t memory_type(const gpu *g, uint32_t allowed, VkMemoryPropertyFlags wanted) {
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(g->physical, &memory);
  for (uint32_t k = 0; k < memory.memoryTypeCount; ++k)
    if ((allowed >> k & 1) && (memory.memoryTypes[k].propertyFlags & wanted) == wanted) return k;
  fail_msg("no memory of the kind 0x%x", wanted);
  return 0;
}

/* Exported: others may have its memory by a file descriptor. Its size is at *size. */
static buffer new_buffer(const gpu *g, int exported, VkMemoryPropertyFlags kind, uint64_t *size) {
  const VkExternalMemoryBufferCreateInfo external = {
      .sType = VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_BUFFER_CREATE_INFO,
      .handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
  const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                   .pNext = exported ? &external : NULL,
                                   .size = bytes,
                                   .usage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT |
                                            VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                            VK_BUFFER_USAGE_TRANSFER_DST_BIT};
  const VkExportMemoryAllocateInfo shared = {
      .sType = VK_STRUCTURE_TYPE_EXPORT_MEMORY_ALLOCATE_INFO,
      .handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
  VkMemoryRequirements needs;
  buffer b = {VK_NULL_HANDLE, VK_NULL_HANDLE};
  OK(vkCreateBuffer(g->device, &info, NULL, &b.buffer));
  vkGetBufferMemoryRequirements(g->device, b.buffer, &needs);
  const VkMemoryAllocateInfo allocation = {
      .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
      .pNext = exported ? &shared : NULL,
      .allocationSize = needs.size,
      .memoryTypeIndex = memory_type(g, needs.memoryTypeBits, kind)};
  OK(vkAllocateMemory(g->device, &allocation, NULL, &b.memory));
  OK(vkBindBufferMemory(g->device, b.buffer, b.memory, 0));
  *size = needs.size;
  return b;
}

static void free_buffer(const gpu *g, buffer *b) {
  vkDestroyBuffer(g->device, b->buffer, NULL);
  vkFreeMemory(g->device, b->memory, NULL);
}

static int descriptor_of_memory(const gpu *g, VkDeviceMemory memory) {
  const VkMemoryGetFdInfoKHR info = {.sType = VK_STRUCTURE_TYPE_MEMORY_GET_FD_INFO_KHR,
                                     .memory = memory,
                                     .handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
  const PFN_vkGetMemoryFdKHR get =
      (PFN_vkGetMemoryFdKHR)vkGetDeviceProcAddr(g->device, "vkGetMemoryFdKHR");
  int descriptor = -1;
  OK(get(g->device, &info, &descriptor));
  return descriptor;
}

static VkSemaphore new_semaphore(const gpu *g, int *descriptor) {
  const VkExportSemaphoreCreateInfo shared = {
      .sType = VK_STRUCTURE_TYPE_EXPORT_SEMAPHORE_CREATE_INFO,
      .handleTypes = VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_OPAQUE_FD_BIT};
  const VkSemaphoreCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO,
                                      .pNext = &shared};
  VkSemaphoreGetFdInfoKHR out = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_GET_FD_INFO_KHR,
                                 .handleType = VK_EXTERNAL_SEMAPHORE_HANDLE_TYPE_OPAQUE_FD_BIT};
  const PFN_vkGetSemaphoreFdKHR get =
      (PFN_vkGetSemaphoreFdKHR)vkGetDeviceProcAddr(g->device, "vkGetSemaphoreFdKHR");
  OK(vkCreateSemaphore(g->device, &info, NULL, &out.semaphore));
  OK(get(g->device, &out, descriptor));
  return out.semaphore;
}

/* Once `ready` is signalled, from one buffer to the other; for the latter the host waits. */
static void copy_when_ready(const gpu *g, VkSemaphore ready, const buffer *from, const buffer *to) {
  const VkCommandBufferAllocateInfo allocation = {
      .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
      .commandPool = g->pool,
      .commandBufferCount = 1};
  const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
  const VkBufferCopy all = {0, 0, bytes};
  VkCommandBuffer commands = VK_NULL_HANDLE;
  OK(vkAllocateCommandBuffers(g->device, &allocation, &commands));
  OK(vkBeginCommandBuffer(commands, &begin));
  vkCmdCopyBuffer(commands, from->buffer, to->buffer, 1, &all);
  OK(vkEndCommandBuffer(commands));
  const VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                               .waitSemaphoreCount = 1,
                               .pWaitSemaphores = &ready,
                               .pWaitDstStageMask = &stage,
                               .commandBufferCount = 1,
                               .pCommandBuffers = &commands};
  OK(vkQueueSubmit(g->queue, 1, &submit, VK_NULL_HANDLE));
  OK(vkQueueWaitIdle(g->queue));
  vkFreeCommandBuffers(g->device, g->pool, 1, &commands);
}

/* ---- The solver ------------------------------------------------------------------------------ */

static pbf_solver *scene(cuda_stream stream) {
  pbf_desc desc = test_desc(3, PBF_FLOAT32, COUNT);
  desc.stream = stream;
  pbf_solver *solver = test_create(&desc, NULL);
  void *positions = test_lattice(3, PBF_FLOAT32, COUNT);
  assert_ok(pbf_add_particles(solver, COUNT, positions, NULL, NULL));
  free(positions);
  return solver;
}

static pbf_read_desc quads(void *data) {
  return (pbf_read_desc){.struct_size = sizeof(pbf_read_desc),
                         .field = PBF_FIELD_POSITION,
                         .count = COUNT,
                         .element_type = PBF_TYPE_FLOAT32,
                         .components = 4,
                         .w = PBF_W_SPEED,
                         .data = data};
}

/* Frame by frame: what Vulkan has copied is what the host reads. */
static void draw(const gpu *g, pbf_solver *solver, cuda_stream stream) {
  static float expected[4 * COUNT];
  const VkMemoryPropertyFlags on_host =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  uint64_t size = 0, ignored = 0;
  int descriptor = -1;
  void *seen = NULL;
  buffer vertices = new_buffer(g, 1, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &size);
  buffer copy = new_buffer(g, 0, on_host, &ignored);
  VkSemaphore ready = new_semaphore(g, &descriptor);
  cuda_semaphore signal = cuda_import_semaphore(descriptor);
  cuda_memory memory = cuda_import_memory(descriptor_of_memory(g, vertices.memory), size);
  OK(vkMapMemory(g->device, copy.memory, 0, bytes, 0, &seen));
  for (int frame = 0; frame < 3; ++frame) {
    memset(seen, 0, bytes);
    assert_ok(pbf_step(solver, STEPS));
    pbf_read_desc read = quads((void *)(uintptr_t)memory.address);
    read.device_type = PBF_DEVICE_CUDA, read.stream = stream;
    assert_ok(pbf_read(solver, &read));
    cuda_signal(signal, stream);
    copy_when_ready(g, ready, &vertices, &copy);
    read = quads(expected);
    assert_ok(pbf_read(solver, &read));
    assert_memory_equal(seen, expected, bytes);
    assert_true(expected[4 * COUNT - 1] > 0); /* it falls */
  }
  cuda_destroy_memory(memory);
  cuda_destroy_semaphore(signal);
  vkDestroySemaphore(g->device, ready, NULL);
  free_buffer(g, &copy);
  free_buffer(g, &vertices);
}

static void a_buffer_of_vulkan_is_written(void **state) {
  (void)state;
  gpu g;
  cuda_primary_context();
  if (!open_gpu(&g)) test_skip("Vulkan does not have the device that CUDA calls 0");
  cuda_stream stream = cuda_create_stream();
  pbf_solver *solver = scene(stream);
  draw(&g, solver, stream);
  pbf_destroy(solver);
  cuda_destroy_stream(stream);
  close_gpu(&g);
  cuda_set_current(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_buffer_of_vulkan_is_written),
  };
  return TEST_RUN(tests);
}
