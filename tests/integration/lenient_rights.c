// An access control plugin that lets its own participant do anything: what a stranger with an identity of ours would build. It
// is Cyclone's ($SEALWATCH_ACCESS_CONTROL) with the checks of what this side makes left out. What the others check is theirs.
#include <dds/security/dds_security_api_access_control.h>
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

typedef int (*Initialise)(const char *argument, void **context, struct ddsi_domaingv *domain);
typedef int (*Finalise)(void *context);

static void *cyclones_own(const char *name) {
  void *const library = dlopen(getenv("SEALWATCH_ACCESS_CONTROL"), RTLD_NOW);
  void *const function = library == NULL ? NULL : dlsym(library, name);
  if (function == NULL) fprintf(stderr, "lenient_rights: %s\n", dlerror());
  return function;
}

static DDS_Security_boolean any_writer(dds_security_access_control *instance, const DDS_Security_PermissionsHandle rights,
                                       const DDS_Security_DomainId domain, const DDS_Security_char *topic,
                                       const DDS_Security_Qos *qos, const DDS_Security_PartitionQosPolicy *partition,
                                       const DDS_Security_DataTags *tags, DDS_Security_SecurityException *exception) {
  (void)instance, (void)rights, (void)domain, (void)topic, (void)qos, (void)partition, (void)tags, (void)exception;
  return true;
}

static DDS_Security_boolean any_topic(dds_security_access_control *instance, const DDS_Security_PermissionsHandle rights,
                                      const DDS_Security_DomainId domain, const DDS_Security_char *topic,
                                      const DDS_Security_Qos *qos, DDS_Security_SecurityException *exception) {
  (void)instance, (void)rights, (void)domain, (void)topic, (void)qos, (void)exception;
  return true;
}

int init_access_control(const char *argument, void **context, struct ddsi_domaingv *domain) {
  const Initialise initialise = (Initialise)cyclones_own("init_access_control");
  const int result = initialise == NULL ? -1 : initialise(argument, context, domain);
  if (result == 0) {
    dds_security_access_control *const control = *context;
    control->check_create_datawriter = any_writer;
    control->check_create_datareader = any_writer;  // of the same form
    control->check_create_topic = any_topic;
  }
  return result;
}

int finalize_access_control(void *context) {
  const Finalise finalise = (Finalise)cyclones_own("finalize_access_control");
  return finalise == NULL ? -1 : finalise(context);
}
