// SPDX-License-Identifier: MIT
#include "daemon/fleet/late_libpq.hpp"

#include <cstddef>
#include <cstdio>

#include <libpq-fe.h>

#include "daemon/files/late_library.hpp"

namespace {

struct Libpq : popcut::LateLibrary {
  Libpq() : LateLibrary("libpq.so.5", "libpq5") {}
  using LateLibrary::function;
};

Libpq& libpq() {
  static Libpq loaded;
  return loaded;
}

/// Calls libpq's own function of the name.
template <auto* function, typename... Values>
auto real(const char* name, Values... values) {
  using Function = decltype(function);
  static const Function kReal = libpq().function(name);
  return kReal(values...);
}

}  // namespace

namespace popcut::daemon {

std::string libpq_fault() { return libpq().fault(); }

}  // namespace popcut::daemon

// All of libpq that libpqxx and popcut call.
extern "C" {
int PQbackendPID(const PGconn* line) { return real<PQbackendPID>("PQbackendPID", line); }
int PQcancel(PGcancel* cancel, char* errbuf, int errbufsize) {
  return real<PQcancel>("PQcancel", cancel, errbuf, errbufsize);
}
void PQclear(PGresult* rows) { return real<PQclear>("PQclear", rows); }
int PQclientEncoding(const PGconn* line) {
  return real<PQclientEncoding>("PQclientEncoding", line);
}
char* PQcmdStatus(PGresult* rows) { return real<PQcmdStatus>("PQcmdStatus", rows); }
char* PQcmdTuples(PGresult* rows) { return real<PQcmdTuples>("PQcmdTuples", rows); }
PostgresPollingStatusType PQconnectPoll(PGconn* line) {
  return real<PQconnectPoll>("PQconnectPoll", line);
}
PGconn* PQconnectStart(const char* conninfo) {
  return real<PQconnectStart>("PQconnectStart", conninfo);
}
PGconn* PQconnectdb(const char* conninfo) { return real<PQconnectdb>("PQconnectdb", conninfo); }
int PQconsumeInput(PGconn* line) { return real<PQconsumeInput>("PQconsumeInput", line); }
char* PQdb(const PGconn* line) { return real<PQdb>("PQdb", line); }
char* PQencryptPassword(const char* passwd, const char* user) {
  return real<PQencryptPassword>("PQencryptPassword", passwd, user);
}
int PQendcopy(PGconn* line) { return real<PQendcopy>("PQendcopy", line); }
char* PQerrorMessage(const PGconn* line) { return real<PQerrorMessage>("PQerrorMessage", line); }
unsigned char* PQescapeByteaConn(PGconn* line, const unsigned char* from, std::size_t from_length,
                                 std::size_t* to_length) {
  return real<PQescapeByteaConn>("PQescapeByteaConn", line, from, from_length, to_length);
}
char* PQescapeIdentifier(PGconn* line, const char* str, std::size_t len) {
  return real<PQescapeIdentifier>("PQescapeIdentifier", line, str, len);
}
std::size_t PQescapeStringConn(PGconn* line, char* to, const char* from, std::size_t length,
                               int* error) {
  return real<PQescapeStringConn>("PQescapeStringConn", line, to, from, length, error);
}
PGresult* PQexec(PGconn* line, const char* query) { return real<PQexec>("PQexec", line, query); }
PGresult* PQexecParams(PGconn* line, const char* command, int n_params, const Oid* param_types,
                       const char* const* param_values, const int* param_lengths,
                       const int* param_formats, int result_format) {
  return real<PQexecParams>("PQexecParams", line, command, n_params, param_types, param_values,
                            param_lengths, param_formats, result_format);
}
PGresult* PQexecPrepared(PGconn* line, const char* stmt_name, int n_params,
                         const char* const* param_values, const int* param_lengths,
                         const int* param_formats, int result_format) {
  return real<PQexecPrepared>("PQexecPrepared", line, stmt_name, n_params, param_values,
                              param_lengths, param_formats, result_format);
}
void PQfinish(PGconn* line) { return real<PQfinish>("PQfinish", line); }
char* PQfname(const PGresult* rows, int field_num) {
  return real<PQfname>("PQfname", rows, field_num);
}
int PQfnumber(const PGresult* rows, const char* field_name) {
  return real<PQfnumber>("PQfnumber", rows, field_name);
}
void PQfreeCancel(PGcancel* cancel) { return real<PQfreeCancel>("PQfreeCancel", cancel); }
void PQfreemem(void* ptr) { return real<PQfreemem>("PQfreemem", ptr); }
Oid PQftable(const PGresult* rows, int field_num) {
  return real<PQftable>("PQftable", rows, field_num);
}
int PQftablecol(const PGresult* rows, int field_num) {
  return real<PQftablecol>("PQftablecol", rows, field_num);
}
Oid PQftype(const PGresult* rows, int field_num) {
  return real<PQftype>("PQftype", rows, field_num);
}
PGcancel* PQgetCancel(PGconn* line) { return real<PQgetCancel>("PQgetCancel", line); }
int PQgetCopyData(PGconn* line, char** buffer, int async) {
  return real<PQgetCopyData>("PQgetCopyData", line, buffer, async);
}
PGresult* PQgetResult(PGconn* line) { return real<PQgetResult>("PQgetResult", line); }
int PQgetisnull(const PGresult* rows, int tup_num, int field_num) {
  return real<PQgetisnull>("PQgetisnull", rows, tup_num, field_num);
}
int PQgetlength(const PGresult* rows, int tup_num, int field_num) {
  return real<PQgetlength>("PQgetlength", rows, tup_num, field_num);
}
char* PQgetvalue(const PGresult* rows, int tup_num, int field_num) {
  return real<PQgetvalue>("PQgetvalue", rows, tup_num, field_num);
}
char* PQhost(const PGconn* line) { return real<PQhost>("PQhost", line); }
int PQisBusy(PGconn* line) { return real<PQisBusy>("PQisBusy", line); }
int PQisthreadsafe() { return real<PQisthreadsafe>("PQisthreadsafe"); }
int PQnfields(const PGresult* rows) { return real<PQnfields>("PQnfields", rows); }
PGnotify* PQnotifies(PGconn* line) { return real<PQnotifies>("PQnotifies", line); }
int PQntuples(const PGresult* rows) { return real<PQntuples>("PQntuples", rows); }
Oid PQoidValue(const PGresult* rows) { return real<PQoidValue>("PQoidValue", rows); }
char* PQport(const PGconn* line) { return real<PQport>("PQport", line); }
PGresult* PQprepare(PGconn* line, const char* stmt_name, const char* query, int n_params,
                    const Oid* param_types) {
  return real<PQprepare>("PQprepare", line, stmt_name, query, n_params, param_types);
}
int PQprotocolVersion(const PGconn* line) {
  return real<PQprotocolVersion>("PQprotocolVersion", line);
}
int PQputCopyData(PGconn* line, const char* buffer, int nbytes) {
  return real<PQputCopyData>("PQputCopyData", line, buffer, nbytes);
}
int PQputCopyEnd(PGconn* line, const char* errormsg) {
  return real<PQputCopyEnd>("PQputCopyEnd", line, errormsg);
}
void PQreset(PGconn* line) { return real<PQreset>("PQreset", line); }
char* PQresultErrorField(const PGresult* rows, int fieldcode) {
  return real<PQresultErrorField>("PQresultErrorField", rows, fieldcode);
}
char* PQresultErrorMessage(const PGresult* rows) {
  return real<PQresultErrorMessage>("PQresultErrorMessage", rows);
}
ExecStatusType PQresultStatus(const PGresult* rows) {
  return real<PQresultStatus>("PQresultStatus", rows);
}
int PQsendQuery(PGconn* line, const char* query) {
  return real<PQsendQuery>("PQsendQuery", line, query);
}
int PQserverVersion(const PGconn* line) { return real<PQserverVersion>("PQserverVersion", line); }
int PQsetClientEncoding(PGconn* line, const char* encoding) {
  return real<PQsetClientEncoding>("PQsetClientEncoding", line, encoding);
}
PGVerbosity PQsetErrorVerbosity(PGconn* line, PGVerbosity verbosity) {
  return real<PQsetErrorVerbosity>("PQsetErrorVerbosity", line, verbosity);
}
PQnoticeProcessor PQsetNoticeProcessor(PGconn* line, PQnoticeProcessor proc, void* arg) {
  return real<PQsetNoticeProcessor>("PQsetNoticeProcessor", line, proc, arg);
}
int PQsocket(const PGconn* line) { return real<PQsocket>("PQsocket", line); }
ConnStatusType PQstatus(const PGconn* line) { return real<PQstatus>("PQstatus", line); }
void PQtrace(PGconn* line, std::FILE* debug_port) {
  return real<PQtrace>("PQtrace", line, debug_port);
}
unsigned char* PQunescapeBytea(const unsigned char* strtext, std::size_t* retbuflen) {
  return real<PQunescapeBytea>("PQunescapeBytea", strtext, retbuflen);
}
void PQuntrace(PGconn* line) { return real<PQuntrace>("PQuntrace", line); }
char* PQuser(const PGconn* line) { return real<PQuser>("PQuser", line); }
const char* pg_encoding_to_char(int encoding) {
  return real<pg_encoding_to_char>("pg_encoding_to_char", encoding);
}
}
