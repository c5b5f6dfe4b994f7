bool isData(float value) { return value < noDataFirst || value > noDataLast; }
