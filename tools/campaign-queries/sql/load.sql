-- Rows of a campaign.csv. docs/campaign.md has the meaning of each column. The last columns say what the rows are of.
-- Columns that are not listed here are read as what they look like; one that is missing is an error.
CREATE MACRO campaign_csv(file) AS TABLE
SELECT * FROM read_csv(file, header = true, delim = ',', quote = '"', nullstr = '', sample_size = -1, types = {
    'number': 'UBIGINT', 'clean': 'BOOLEAN', 'machine': 'VARCHAR', 'axes': 'UTINYINT', 'drive': 'VARCHAR', 'encoder': 'BOOLEAN',
    'model_level': 'VARCHAR', 'tick_hz': 'UINTEGER', 'proves_wiring': 'BOOLEAN',
    'kind': 'VARCHAR', 'axis': 'UTINYINT', 'at_s': 'DOUBLE', 'for_s': 'DOUBLE', 'size': 'DOUBLE', 'state': 'VARCHAR', 'speed_hz': 'DOUBLE',
    'beyond_limit_s': 'DOUBLE', 'reported_s': 'DOUBLE', 'detected_s': 'DOUBLE', 'turns_from_fault': 'DOUBLE', 'turns_from_limit': 'DOUBLE',
    'in_time': 'BOOLEAN', 'fault': 'VARCHAR', 'fault_axis': 'UTINYINT', 'reported_faults': 'VARCHAR', 'verdict': 'VARCHAR',
    'tilt_mrad': 'DOUBLE', 'tilt_off_mrad': 'DOUBLE', 'bound_mrad': 'DOUBLE', 'limit_mrad': 'DOUBLE', 'tilt_hold_mrad': 'DOUBLE', 'hold_bound_mrad': 'DOUBLE',
    'left_running_turns': 'DOUBLE', 'left_running': 'BOOLEAN', 'ended': 'VARCHAR', 'simulated_s': 'DOUBLE',
    'version': 'VARCHAR', 'commit': 'VARCHAR', 'plan': 'UBIGINT', 'seed': 'UBIGINT', 'scene': 'VARCHAR', 'only': 'VARCHAR', 'others': 'UBIGINT',
    'from': 'UBIGINT', 'to': 'UBIGINT', 'of': 'UBIGINT', 'crc32': 'VARCHAR'
});
