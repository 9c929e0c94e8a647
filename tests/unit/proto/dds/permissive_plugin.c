/* Cyclone DDS's plugin of access control, but whatever this process itself makes is allowed: what
 * somebody has who changes his own copy. KINSHIP_ACCESS_CONTROL: file of that plugin. */
#include <dds/dds.h>
#include <dds/security/dds_security_api.h>
#include <dlfcn.h>
#include <stddef.h>
#include <stdlib.h>

typedef int (*init_function)(const char*, void**, struct ddsi_domaingv*);
typedef int (*finalize_function)(void*);

static void* behind;

static DDS_Security_boolean allow_writer(dds_security_access_control* instance,
                                         const DDS_Security_PermissionsHandle permissions,
                                         const DDS_Security_DomainId domain, const char* topic,
                                         const DDS_Security_Qos* qos,
                                         const DDS_Security_PartitionQosPolicy* partition,
                                         const DDS_Security_DataTags* tags,
                                         DDS_Security_SecurityException* exception) {
  (void)instance, (void)permissions, (void)domain, (void)topic, (void)qos, (void)partition;
  (void)tags, (void)exception;
  return 1;
}

static DDS_Security_boolean allow_reader(dds_security_access_control* instance,
                                         const DDS_Security_PermissionsHandle permissions,
                                         const DDS_Security_DomainId domain, const char* topic,
                                         const DDS_Security_Qos* qos,
                                         const DDS_Security_PartitionQosPolicy* partition,
                                         const DDS_Security_DataTags* tags,
                                         DDS_Security_SecurityException* exception) {
  (void)instance, (void)permissions, (void)domain, (void)topic, (void)qos, (void)partition;
  (void)tags, (void)exception;
  return 1;
}

static DDS_Security_boolean allow_topic(dds_security_access_control* instance,
                                        const DDS_Security_PermissionsHandle permissions,
                                        const DDS_Security_DomainId domain, const char* topic,
                                        const DDS_Security_Qos* qos,
                                        DDS_Security_SecurityException* exception) {
  (void)instance, (void)permissions, (void)domain, (void)topic, (void)qos, (void)exception;
  return 1;
}

int init_access_control(const char* argument, void** context, struct ddsi_domaingv* domain) {
  behind = dlopen(getenv("KINSHIP_ACCESS_CONTROL"), RTLD_NOW);
  if (behind == NULL)
    return -1;
  const init_function init = (init_function)dlsym(behind, "init_access_control");
  const int result = init(argument, context, domain);
  if (result == 0) {
    dds_security_access_control* const plugin = *context;
    plugin->check_create_datawriter = allow_writer;
    plugin->check_create_datareader = allow_reader;
    plugin->check_create_topic = allow_topic;
  }
  return result;
}

int finalize_access_control(void* context) {
  const finalize_function finalize = (finalize_function)dlsym(behind, "finalize_access_control");
  return finalize(context);
}
