"""The Lua scripts: every write that must happen exactly once, each idempotent by its arguments.

Common to Redis >= 7.0 and Valkey >= 7.2. A client library that retries a call after a lost reply repeats the
same arguments, and the second run finds the first one's mark and changes nothing.
"""

# Appends a frame unless (session, sequence) is already in the log.
# KEYS stream, sequences, frame-ids, scenes. ARGV session, sequence, frame id, scene, field, value, ...
# -> {entry id, 1 where it was a duplicate, number of entries}
INGEST = """
local last = tonumber(redis.call('HGET', KEYS[2], ARGV[1]) or '-1')
local known = redis.call('HGET', KEYS[3], ARGV[3])
if known then return {known, 1, redis.call('XLEN', KEYS[1])} end
if tonumber(ARGV[2]) <= last then return {'', 1, redis.call('XLEN', KEYS[1])} end
local fields = {}
for i = 5, #ARGV do fields[#fields + 1] = ARGV[i] end
local id = redis.call('XADD', KEYS[1], '*', unpack(fields))
redis.call('HSET', KEYS[2], ARGV[1], ARGV[2])
redis.call('HSET', KEYS[3], ARGV[3], id)
return {id, 0, redis.call('XLEN', KEYS[1])}
"""

# Takes the lease where it is free or already ours. KEYS lease, fence. ARGV owner, ttl in ms.
# -> fence number, or 0 where another owner holds it
ACQUIRE = """
local holder = redis.call('HGET', KEYS[1], 'owner')
if holder and holder ~= ARGV[1] then return 0 end
local fence = holder and redis.call('HGET', KEYS[1], 'fence') or redis.call('INCR', KEYS[2])
redis.call('HSET', KEYS[1], 'owner', ARGV[1], 'fence', fence)
redis.call('PEXPIRE', KEYS[1], ARGV[2])
return tonumber(fence)
"""

# Keeps the lease. KEYS lease. ARGV owner, fence, ttl in ms. -> 1 kept, 0 lost
RENEW = """
if redis.call('HGET', KEYS[1], 'owner') ~= ARGV[1] then return 0 end
if redis.call('HGET', KEYS[1], 'fence') ~= ARGV[2] then return 0 end
redis.call('PEXPIRE', KEYS[1], ARGV[3])
return 1
"""

# Gives the lease back. KEYS lease. ARGV owner, fence. -> 1 given back, 0 was not ours
RELEASE = """
if redis.call('HGET', KEYS[1], 'owner') ~= ARGV[1] then return 0 end
if redis.call('HGET', KEYS[1], 'fence') ~= ARGV[2] then return 0 end
return redis.call('DEL', KEYS[1])
"""

# Appends an entry unless its key has one already. KEYS log, hash of keys. ARGV key, field, value, ...
# -> {entry id, 1 where it was there}
APPEND_ONCE = """
local known = redis.call('HGET', KEYS[2], ARGV[1])
if known then return {known, 1} end
local fields = {}
for i = 2, #ARGV do fields[#fields + 1] = ARGV[i] end
local id = redis.call('XADD', KEYS[1], '*', unpack(fields))
redis.call('HSET', KEYS[2], ARGV[1], id)
return {id, 0}
"""

# A stage's step: fence still ours and every input newer than its cursor -> append, put, move the cursors.
# KEYS lease, state, then one stream per append.
# ARGV owner, fence, number of cursors, cursor field, input id, ..., number of puts, put name, put value, ...,
#      then per append: entry id or *, number of words, words
# -> {1 applied | 0 already applied | -1 lease lost | -2 some cursors are there, some are not, entry ids ...}
COMMIT = """
local function parts(id)
  local ms, seq = string.match(id, '^(%d+)-(%d+)$')
  return tonumber(ms), tonumber(seq)
end
local function after(id, other)
  local ms, seq = parts(id)
  local other_ms, other_seq = parts(other)
  return ms > other_ms or (ms == other_ms and seq > other_seq)
end
if redis.call('HGET', KEYS[1], 'owner') ~= ARGV[1] or redis.call('HGET', KEYS[1], 'fence') ~= ARGV[2] then
  return {-1}
end
local cursors = tonumber(ARGV[3])
local ahead = 0
for i = 1, cursors do
  local cursor = redis.call('HGET', KEYS[2], ARGV[2 + 2 * i]) or '0-0'
  if after(ARGV[3 + 2 * i], cursor) then ahead = ahead + 1 end
end
if ahead == 0 then return {0} end
if ahead < cursors then return {-2} end
local puts = 4 + 2 * cursors
local first = puts + 1 + 2 * tonumber(ARGV[puts])
local at = first
local newest = {}
for k = 3, #KEYS do  -- a script that fails half way keeps what it wrote before
  local kind = redis.call('TYPE', KEYS[k]).ok
  if kind ~= 'none' and kind ~= 'stream' then return redis.error_reply('ERR ' .. KEYS[k] .. ' is no log') end
  if ARGV[at] ~= '*' then
    if not newest[KEYS[k]] then
      local last = redis.call('XREVRANGE', KEYS[k], '+', '-', 'COUNT', 1)
      newest[KEYS[k]] = last[1] and last[1][1] or '0-0'
    end
    if not after(ARGV[at], newest[KEYS[k]]) then
      return redis.error_reply('ERR ' .. KEYS[k] .. ' is already at ' .. newest[KEYS[k]])
    end
    newest[KEYS[k]] = ARGV[at]
  end
  at = at + 2 + tonumber(ARGV[at + 1])
end
for i = puts + 1, first - 1, 2 do redis.call('HSET', KEYS[2], 'v:' .. ARGV[i], ARGV[i + 1]) end
local reply = {1}
at = first
for k = 3, #KEYS do
  local n = tonumber(ARGV[at + 1])
  local fields = {}
  for i = at + 2, at + 1 + n do fields[#fields + 1] = ARGV[i] end
  reply[#reply + 1] = redis.call('XADD', KEYS[k], ARGV[at], unpack(fields))
  at = at + 2 + n
end
for i = 1, cursors do redis.call('HSET', KEYS[2], ARGV[2 + 2 * i], ARGV[3 + 2 * i]) end
return reply
"""

# Compare-and-set of a document. KEYS documents. ARGV name, expected revision, bytes.
# -> new revision; or -current where it is neither the expected one nor already these bytes one revision on
SAVE = """
local current = tonumber(redis.call('HGET', KEYS[1], 'r:' .. ARGV[1]) or '0')
local expected = tonumber(ARGV[2])
if current == expected + 1 and redis.call('HGET', KEYS[1], 'b:' .. ARGV[1]) == ARGV[3] then return current end
if current ~= expected then return -1 - current end
redis.call('HSET', KEYS[1], 'r:' .. ARGV[1], current + 1, 'b:' .. ARGV[1], ARGV[3])
return current + 1
"""

# Token bucket on the store's own clock. KEYS bucket. ARGV capacity, refill a second, amount.
# -> "0" taken, else seconds until there is enough. A retried take may take twice: the budget errs on the safe side.
TAKE = """
local now = redis.call('TIME')
local t = tonumber(now[1]) + tonumber(now[2]) / 1e6
local capacity, refill, amount = tonumber(ARGV[1]), tonumber(ARGV[2]), tonumber(ARGV[3])
local level = tonumber(redis.call('HGET', KEYS[1], 'level') or capacity)
local stamp = tonumber(redis.call('HGET', KEYS[1], 'stamp') or t)
level = math.min(capacity, level + math.max(0, t - stamp) * refill)
local wait = 0
if level >= amount then
  level = level - amount
else
  wait = (amount - level) / refill
end
redis.call('HSET', KEYS[1], 'level', tostring(level), 'stamp', string.format('%.6f', t))
redis.call('PEXPIRE', KEYS[1], math.ceil(1000 * capacity / refill) + 60000)
return tostring(wait)
"""
