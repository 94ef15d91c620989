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

// All of libpq that libpqxx and popcut call, with its own names of parameters.
extern "C" {
int PQbackendPID(const PGconn* conn) { return real<PQbackendPID>("PQbackendPID", conn); }
int PQcancel(PGcancel* cancel, char* errbuf, int errbufsize) {
  return real<PQcancel>("PQcancel", cancel, errbuf, errbufsize);
}
void PQclear(PGresult* res) { return real<PQclear>("PQclear", res); }
int PQclientEncoding(const PGconn* conn) {
  return real<PQclientEncoding>("PQclientEncoding", conn);
}
char* PQcmdStatus(PGresult* res) { return real<PQcmdStatus>("PQcmdStatus", res); }
char* PQcmdTuples(PGresult* res) { return real<PQcmdTuples>("PQcmdTuples", res); }
PostgresPollingStatusType PQconnectPoll(PGconn* conn) {
  return real<PQconnectPoll>("PQconnectPoll", conn);
}
PGconn* PQconnectStart(const char* conninfo) {
  return real<PQconnectStart>("PQconnectStart", conninfo);
}
PGconn* PQconnectdb(const char* conninfo) { return real<PQconnectdb>("PQconnectdb", conninfo); }
int PQconsumeInput(PGconn* conn) { return real<PQconsumeInput>("PQconsumeInput", conn); }
char* PQdb(const PGconn* conn) { return real<PQdb>("PQdb", conn); }
char* PQencryptPassword(const char* passwd, const char* user) {
  return real<PQencryptPassword>("PQencryptPassword", passwd, user);
}
int PQendcopy(PGconn* conn) { return real<PQendcopy>("PQendcopy", conn); }
char* PQerrorMessage(const PGconn* conn) { return real<PQerrorMessage>("PQerrorMessage", conn); }
unsigned char* PQescapeByteaConn(PGconn* conn, const unsigned char* from, std::size_t from_length,
                                 std::size_t* to_length) {
  return real<PQescapeByteaConn>("PQescapeByteaConn", conn, from, from_length, to_length);
}
char* PQescapeIdentifier(PGconn* conn, const char* str, std::size_t len) {
  return real<PQescapeIdentifier>("PQescapeIdentifier", conn, str, len);
}
std::size_t PQescapeStringConn(PGconn* conn, char* to, const char* from, std::size_t length,
                               int* error) {
  return real<PQescapeStringConn>("PQescapeStringConn", conn, to, from, length, error);
}
PGresult* PQexec(PGconn* conn, const char* query) { return real<PQexec>("PQexec", conn, query); }
PGresult* PQexecParams(PGconn* conn, const char* command, int nParams, const Oid* paramTypes,
                       const char* const* paramValues, const int* paramLengths,
                       const int* paramFormats, int resultFormat) {
  return real<PQexecParams>("PQexecParams", conn, command, nParams, paramTypes, paramValues,
                            paramLengths, paramFormats, resultFormat);
}
PGresult* PQexecPrepared(PGconn* conn, const char* stmtName, int nParams,
                         const char* const* paramValues, const int* paramLengths,
                         const int* paramFormats, int resultFormat) {
  return real<PQexecPrepared>("PQexecPrepared", conn, stmtName, nParams, paramValues, paramLengths,
                              paramFormats, resultFormat);
}
void PQfinish(PGconn* conn) { return real<PQfinish>("PQfinish", conn); }
char* PQfname(const PGresult* res, int field_num) {
  return real<PQfname>("PQfname", res, field_num);
}
int PQfnumber(const PGresult* res, const char* field_name) {
  return real<PQfnumber>("PQfnumber", res, field_name);
}
void PQfreeCancel(PGcancel* cancel) { return real<PQfreeCancel>("PQfreeCancel", cancel); }
void PQfreemem(void* ptr) { return real<PQfreemem>("PQfreemem", ptr); }
Oid PQftable(const PGresult* res, int field_num) {
  return real<PQftable>("PQftable", res, field_num);
}
int PQftablecol(const PGresult* res, int field_num) {
  return real<PQftablecol>("PQftablecol", res, field_num);
}
Oid PQftype(const PGresult* res, int field_num) { return real<PQftype>("PQftype", res, field_num); }
PGcancel* PQgetCancel(PGconn* conn) { return real<PQgetCancel>("PQgetCancel", conn); }
int PQgetCopyData(PGconn* conn, char** buffer, int async) {
  return real<PQgetCopyData>("PQgetCopyData", conn, buffer, async);
}
PGresult* PQgetResult(PGconn* conn) { return real<PQgetResult>("PQgetResult", conn); }
int PQgetisnull(const PGresult* res, int tup_num, int field_num) {
  return real<PQgetisnull>("PQgetisnull", res, tup_num, field_num);
}
int PQgetlength(const PGresult* res, int tup_num, int field_num) {
  return real<PQgetlength>("PQgetlength", res, tup_num, field_num);
}
char* PQgetvalue(const PGresult* res, int tup_num, int field_num) {
  return real<PQgetvalue>("PQgetvalue", res, tup_num, field_num);
}
char* PQhost(const PGconn* conn) { return real<PQhost>("PQhost", conn); }
int PQisBusy(PGconn* conn) { return real<PQisBusy>("PQisBusy", conn); }
int PQisthreadsafe() { return real<PQisthreadsafe>("PQisthreadsafe"); }
int PQnfields(const PGresult* res) { return real<PQnfields>("PQnfields", res); }
PGnotify* PQnotifies(PGconn* conn) { return real<PQnotifies>("PQnotifies", conn); }
int PQntuples(const PGresult* res) { return real<PQntuples>("PQntuples", res); }
Oid PQoidValue(const PGresult* res) { return real<PQoidValue>("PQoidValue", res); }
char* PQport(const PGconn* conn) { return real<PQport>("PQport", conn); }
PGresult* PQprepare(PGconn* conn, const char* stmtName, const char* query, int nParams,
                    const Oid* paramTypes) {
  return real<PQprepare>("PQprepare", conn, stmtName, query, nParams, paramTypes);
}
int PQprotocolVersion(const PGconn* conn) {
  return real<PQprotocolVersion>("PQprotocolVersion", conn);
}
int PQputCopyData(PGconn* conn, const char* buffer, int nbytes) {
  return real<PQputCopyData>("PQputCopyData", conn, buffer, nbytes);
}
int PQputCopyEnd(PGconn* conn, const char* errormsg) {
  return real<PQputCopyEnd>("PQputCopyEnd", conn, errormsg);
}
void PQreset(PGconn* conn) { return real<PQreset>("PQreset", conn); }
char* PQresultErrorField(const PGresult* res, int fieldcode) {
  return real<PQresultErrorField>("PQresultErrorField", res, fieldcode);
}
char* PQresultErrorMessage(const PGresult* res) {
  return real<PQresultErrorMessage>("PQresultErrorMessage", res);
}
ExecStatusType PQresultStatus(const PGresult* res) {
  return real<PQresultStatus>("PQresultStatus", res);
}
int PQsendQuery(PGconn* conn, const char* query) {
  return real<PQsendQuery>("PQsendQuery", conn, query);
}
int PQserverVersion(const PGconn* conn) { return real<PQserverVersion>("PQserverVersion", conn); }
int PQsetClientEncoding(PGconn* conn, const char* encoding) {
  return real<PQsetClientEncoding>("PQsetClientEncoding", conn, encoding);
}
PGVerbosity PQsetErrorVerbosity(PGconn* conn, PGVerbosity verbosity) {
  return real<PQsetErrorVerbosity>("PQsetErrorVerbosity", conn, verbosity);
}
PQnoticeProcessor PQsetNoticeProcessor(PGconn* conn, PQnoticeProcessor proc, void* arg) {
  return real<PQsetNoticeProcessor>("PQsetNoticeProcessor", conn, proc, arg);
}
int PQsocket(const PGconn* conn) { return real<PQsocket>("PQsocket", conn); }
ConnStatusType PQstatus(const PGconn* conn) { return real<PQstatus>("PQstatus", conn); }
void PQtrace(PGconn* conn, std::FILE* debug_port) {
  return real<PQtrace>("PQtrace", conn, debug_port);
}
unsigned char* PQunescapeBytea(const unsigned char* strtext, std::size_t* retbuflen) {
  return real<PQunescapeBytea>("PQunescapeBytea", strtext, retbuflen);
}
void PQuntrace(PGconn* conn) { return real<PQuntrace>("PQuntrace", conn); }
char* PQuser(const PGconn* conn) { return real<PQuser>("PQuser", conn); }
const char* pg_encoding_to_char(int encoding) {
  return real<pg_encoding_to_char>("pg_encoding_to_char", encoding);
}
}
